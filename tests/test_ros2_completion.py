"""Tab in a shell: what argcomplete's shell function gets from the `ros2` program."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.domains import own_domain
from tests.ros2_command import COMMAND, program


@pytest.fixture(scope="module", autouse=True)
def world() -> Iterator[None]:
    with own_domain(), program("tests.ros2_transcripts.world"):
        yield


def completions(line: str, folder: Path) -> list[str]:
    answer = folder / "completions"
    variables = {
        "_ARGCOMPLETE": "1",
        "_ARGCOMPLETE_IFS": "\n",
        "_ARGCOMPLETE_STDOUT_FILENAME": str(answer),
        "COMP_LINE": line,
        "COMP_POINT": str(len(line)),
        "COMP_TYPE": "9",
    }
    subprocess.run(COMMAND, env=os.environ | variables, timeout=30, check=False)
    return [word.strip() for word in answer.read_text().splitlines()]


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("ros2 serv", ["service"]),
        ("ros2 topic del", ["delay"]),
        ("ros2 topic info /ro", ["/robot1/cmd_vel", "/robot1/scan", "/rosout"]),
        ("ros2 topic list --show", ["--show-types"]),
        ("ros2 node info /rob", ["/robot1/lidar"]),
        ("ros2 service call /robot1/en", ["/robot1/enable"]),
        ("ros2 service call /robot1/enable std", ["std_srvs/srv/SetBool"]),
        ("ros2 action info /f", ["/fibonacci"]),
        ("ros2 param get /robot1/lidar be", ["beams"]),
        ("ros2 topic pub /robot1/cmd_vel geo", ["geometry_msgs/msg/Twist"]),
    ],
)
def test_tab_offers_what_fits(line, expected, tmp_path):
    assert completions(line, tmp_path) == expected


def test_the_shell_function_is_registered_in_a_bash():
    code = 'eval "$(register-python-argcomplete ros2)"; complete -p ros2'
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    out = subprocess.run(["bash", "-c", code], env=os.environ | {"PATH": path}, capture_output=True, text=True)
    assert "_python_argcomplete" in out.stdout
