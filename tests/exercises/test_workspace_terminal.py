"""Programs that a check starts in a workspace: the course's own `ros2`, whatever lies there, finds what is built."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from course_kit.exercises.checker import workspace_terminal
from course_kit.exercises.checker.examination import Ended, Examination
from course_kit.exercises.checker.workspace_assertions import expect_executable, expect_package, run_to_end, start
from tests.packages import write

NAME = "demo_py"
MODULES = "lib/python3/site-packages"
WITNESS = "import pathlib\npathlib.Path(__file__ + '.loaded').touch()\n"
SHOW = f"""#!{sys.executable}
import mine, os
print(mine.WORDS, os.environ["ROS_DOMAIN_ID"])
"""


@pytest.fixture
def workspace(examination: Examination, tmp_path: Path) -> Path:
    """One with a package whose folders are full of what would take the place of something."""
    examination.folder, workspace = tmp_path, tmp_path / "ros2_ws"
    hooks = [("PYTHONPATH", MODULES), ("PATH", "bin"), ("AMENT_PREFIX_PATH", ""), ("LD_LIBRARY_PATH", "lib")]
    false = f"#!/bin/sh\ntouch {workspace}/$(basename $0).run\n"
    files = {
        f"share/colcon-core/packages/{NAME}": "",
        f"share/ament_index/resource_index/packages/{NAME}": "",
        f"share/{NAME}/package.dsv": "".join(f"prepend-non-duplicate;{name};{value}\n" for name, value in hooks),
        f"lib/{NAME}/show": SHOW,
        f"{MODULES}/mine.py": "WORDS = 'of the workspace'\n",
        **{f"{MODULES}/{module}.py": WITNESS for module in ("argparse", "ament_index_python", "std_msgs")},
        **{f"bin/{command}": false for command in ("ros2", "python3", "sh", "dirname")},
    }
    write(workspace / "install" / NAME, files)
    (workspace / "install/setup.bash").write_text(f"touch {workspace}/setup.bash.run\n")
    for path in (*workspace.glob("install/demo_py/bin/*"), workspace / f"install/{NAME}/lib/{NAME}/show"):
        path.chmod(0o755)
    return workspace


def test_ros2_is_the_course_s_own_and_finds_the_package(examination: Examination, workspace: Path) -> None:
    prefix = run_to_end("ros2", "pkg", "prefix", NAME, timeout=30.0)
    assert (prefix.status, prefix.lines) == (0, [str(workspace / "install" / NAME)]), prefix.output
    assert list(workspace.rglob("*.run")) + list(workspace.rglob("*.loaded")) == []


def test_a_student_s_program_finds_its_modules_on_the_stage(examination: Examination, workspace: Path) -> None:
    for path in workspace.glob(f"install/{NAME}/{MODULES}/a*.py"):
        path.unlink()
    shown = run_to_end("ros2", "run", NAME, "show", timeout=30.0)
    assert shown.lines == [f"of the workspace {examination.test_domain.domain}"], shown.output


@pytest.mark.parametrize("place", [f"install/{NAME}/{MODULES}/rclpy.py", "course_kit/__init__.py"])
def test_a_module_in_the_place_of_ros_is_named(examination: Examination, workspace: Path, place: str) -> None:
    write(workspace, {place: WITNESS})
    with pytest.raises(Ended):
        start("ros2", "pkg", "list")
    assert f"{Path(place).parent if 'course' in place else place} has the name of a module" in (
        examination.findings[-1].hint
    )


def test_beside_apt_s_ros_its_ros2_is_started_and_its_modules_come_first(
    examination: Examination, workspace: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ros = tmp_path / "opt/ros/jazzy"
    write(ros, {"share/ament_index/resource_index/packages/rclpy": "", "bin/ros2": ""})
    (ros / "bin/ros2").chmod(0o755)
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(ros))
    monkeypatch.setenv("ROS_DISTRO", "jazzy")
    monkeypatch.setattr(sys, "path", [*sys.path, str(ros / "lib")])
    assert workspace_terminal.command(["ros2", "run"]) == [str(ros / "bin/ros2"), "run"]
    environ = workspace_terminal.environment()
    assert environ["PYTHONPATH"].split(":") == [str(ros / "lib"), str(workspace / "install" / NAME / MODULES)]
    assert environ["AMENT_PREFIX_PATH"].split(":") == [str(ros), str(workspace / "install" / NAME)]


@pytest.mark.timeout(20)
@pytest.mark.parametrize("file", ["package.xml", "setup.py", f"{NAME}/talker.py", "launch/demo.launch.py"])
@pytest.mark.parametrize("make", [os.mkfifo, lambda path: path.symlink_to("/dev/zero")], ids=["fifo", "device"])
def test_what_is_no_regular_file_blocks_no_check(
    examination: Examination, workspace: Path, file: str, make: Callable[[Path], None]
) -> None:
    manifest = "<package><export><build_type>ament_python</build_type></export></package>"
    files = {"package.xml": manifest, f"{NAME}/mine.py": "WORDS = 'of the workspace'\n", "setup.py": "", file: ""}
    described = {f"{MODULES}/{NAME}.egg-info/entry_points.txt": f"[console_scripts]\nshow = {NAME}.mine:main\n"}
    write(workspace / "src" / NAME, files)
    write(workspace / "install" / NAME, {**described, f"{MODULES}/{NAME}/mine.py": files[f"{NAME}/mine.py"]})
    (workspace / "src" / NAME / file).unlink()
    make(workspace / "src" / NAME / file)
    with contextlib.suppress(Ended):
        expect_package(NAME, "ament_python")
        expect_executable(NAME, "show")
    assert examination.findings[-1].hint
