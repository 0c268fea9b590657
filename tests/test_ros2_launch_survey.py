"""What the launch files of public packages use of launch: all of it runs, or is refused by its name."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from course_kit.cli.launching import substitution_texts, xml_and_yaml_actions
from tests.ros2_launches import Prefix, RunningGroup

SURVEY = yaml.safe_load((Path(__file__).parent / "launch_survey.yaml").read_text())
USES: dict[str, int] = SURVEY["uses"]
# They load plugins of C++, look at other launches, or came after Jazzy.
REFUSED = {
    "<node_container>",
    "launch.LaunchIntrospector",
    "launch.actions.ForEach",
    "launch_ros.actions.ComposableNodeContainer",
    "launch_ros.actions.LoadComposableNodes",
    "launch_ros.descriptions.ComposableNode",
}


def words(pattern: str) -> set[str]:
    return {match.group(1) for name in USES if (match := re.fullmatch(pattern, name))}


def test_many_packages_were_looked_at() -> None:
    assert len(SURVEY["packages"]) >= 20
    assert set(USES) > REFUSED


def test_tags_and_substitutions_of_many_packages_are_known() -> None:
    assert {f"<{name}>" for name in words("<(.*)>") - set(xml_and_yaml_actions._MAKE)} == REFUSED & {"<node_container>"}
    assert {"var", "env"} < words(r"\$\((.*)\)") <= set(substitution_texts._KNOWN)


def test_entities_of_many_packages_can_be_imported() -> None:
    names = {name for name in USES if name.startswith("launch")} - REFUSED
    imports = ["from {} import {}".format(*name.rsplit(".", 1)) for name in sorted(names)]
    start = "from course_kit.cli.launching import stand_ins; stand_ins.install()"
    subprocess.run([sys.executable, "-c", "\n".join([start, *imports])], check=True)


@pytest.mark.parametrize("name", sorted(REFUSED))
def test_the_rest_is_refused_by_its_name(tmp_path: Path, name: str) -> None:
    path = tmp_path / ("refused.launch.xml" if name.startswith("<") else "refused.launch.py")
    path.write_text(
        f"<launch>{name[:-1]}/></launch>" if name.startswith("<") else "from {} import {}".format(*name.rsplit(".", 1))
    )
    with RunningGroup("launch", path, environment=Prefix(tmp_path).environment) as running:
        assert running.end().status == 1
        (line,) = running.lines[2:]
        assert f"{name} is not covered here: it needs the real `ros2 launch`" in line
