"""The checker is nobody's child but ours: what a notebook has changed around itself does not reach it."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from course_kit.exercises.checker import own_types
from course_kit.exercises.in_notebook import checker_environment
from tests.domains import OF_NO_TEST
from tests.kernel import Kernel

pytestmark = [pytest.mark.usefixtures("fresh_domain"), pytest.mark.timeout(120)]

WITNESS = """
import os, sys
with open({file!r}, "a") as file:
    file.write(f"{{os.getpid()}}\\n")
"""
PACKAGE = "robot_interfaces"
TEXTS = own_types.own_texts(PACKAGE)
BLOCKED = """
import os, sys
from course_kit.exercises.checker import server
from course_kit.exercises.checker.examination import OutOfTime
os.mkfifo(sys.argv[1])
server._watch_over(0.3)
try:
    open(sys.argv[1]).read()
except OutOfTime:
    print("out of time")
"""


@pytest.fixture
def poisoned(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[Kernel, Path]]:
    """A kernel in whose surroundings code lies that every Python would load, and a file with who has loaded it."""
    witness = tmp_path / "loaded"
    code = WITNESS.format(file=str(witness))
    for name in ("sitecustomize.py", "usercustomize.py", "course_kit.py", "signal.py"):
        (tmp_path / "poison" / name).parent.mkdir(exist_ok=True)
        (tmp_path / "poison" / name).write_text(code)
    for name in ("ros2", "python3", "python"):
        (tmp_path / "poison" / name).write_text("#!/bin/sh\nexit 1\n")
        (tmp_path / "poison" / name).chmod(0o755)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    kernel = Kernel()
    kernel.run(
        "from course_kit import check\nfrom course_kit.exercises.in_notebook import checker_client\nimport os, sys"
    )
    poison = {
        "PYTHONPATH": str(tmp_path / "poison"),
        "PYTHONSTARTUP": str(tmp_path / "poison/sitecustomize.py"),
        "PYTHONUSERBASE": str(tmp_path / "poison"),
        "XDG_CACHE_HOME": str(tmp_path / "poison"),
        "LD_PRELOAD": "libm.so.6",
        "AMENT_PREFIX_PATH": str(tmp_path / "poison"),
        "COLCON_PREFIX_PATH": str(tmp_path / "poison"),
        "PATH": f"{tmp_path / 'poison'}:{os.environ['PATH']}",
        "ROS_DOMAIN_ID": str(OF_NO_TEST),
    }
    kernel.run(f"os.environ.update({poison!r})")
    yield kernel, witness
    kernel.close()


def test_nothing_of_the_notebook_s_environment_is_loaded(poisoned: tuple[Kernel, Path], tmp_path: Path) -> None:
    kernel, witness = poisoned
    shown = kernel.text(kernel.run('check("topics-1")', 60))
    assert "not begun" in shown
    checker = int(kernel.text(kernel.run("checker_client.pid()")))
    loaded = witness.read_text().split() if witness.exists() else []
    assert str(checker) not in loaded
    environ = Path(f"/proc/{checker}/environ").read_text().split("\0")
    assert not [entry for entry in environ if str(tmp_path / "poison") in entry]
    assert not [entry for entry in environ if entry.startswith(("LD_PRELOAD=", "PYTHON"))]
    assert "-I" in Path(f"/proc/{checker}/cmdline").read_text().split("\0")


def test_a_domain_that_no_node_uses_is_no_answer(poisoned: tuple[Kernel, Path]) -> None:
    kernel, _ = poisoned
    unused = kernel.text(kernel.run(f'check("setup-1", ({OF_NO_TEST}, "LOCALHOST"))', 60))
    assert f"You gave {OF_NO_TEST}" in unused
    own = os.environ["ROS_DOMAIN_ID"]
    assert ": 1 of 1 point" in kernel.text(kernel.run(f'check("setup-1", ({own}, "LOCALHOST"))', 60))
    kernel.run(f"import rclpy\nrclpy.init(domain_id={OF_NO_TEST})")  # now its nodes are there
    assert ": 1 of 1 point" in kernel.text(kernel.run(f'check("setup-1", ({OF_NO_TEST}, "LOCALHOST"))', 60))


def test_a_read_that_blocks_is_ended(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", BLOCKED, str(tmp_path / "fifo")], capture_output=True, text=True, timeout=30
    )
    assert done.stdout == "out of time\n", done.stderr


def test_the_types_of_the_checker_lie_with_the_course(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert own_types.folder_of(PACKAGE, TEXTS).is_relative_to(sys.prefix)


def test_types_are_kept_for_the_process_where_the_course_cannot_be_written(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(own_types, "base", lambda: Path("/proc/no_such"))
    folder = own_types.folder_of(PACKAGE, TEXTS)
    assert folder.parent.is_dir() and not folder.is_relative_to("/proc")


def test_types_that_were_compiled_are_used_where_nothing_can_be_written(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(own_types, "base", lambda: tmp_path)
    (compiled := own_types.folder_of(PACKAGE, TEXTS)).mkdir()
    assert compiled.parent == tmp_path
    monkeypatch.setattr(os, "access", lambda *_: False)
    assert own_types.folder_of(PACKAGE, TEXTS) == compiled
    assert own_types.folder_of(PACKAGE, {"msg/Other.msg": ""}).parent != tmp_path


def test_of_a_sourced_ros_all_is_kept_that_lies_in_its_folder(tmp_path: Path) -> None:
    ros = tmp_path / "opt/ros/jazzy"
    (ros / "share/ament_index/resource_index/packages").mkdir(parents=True)
    (ros / "share/ament_index/resource_index/packages/rclpy").touch()
    start = {
        "HOME": "/home/ada",
        "ROS_DISTRO": "jazzy",
        "AMENT_PREFIX_PATH": f"/home/ada/ws/install/a:{ros}",
        "PYTHONPATH": f"/home/ada/ws:{ros}/lib/python3.12/site-packages",
        "LD_LIBRARY_PATH": f"{ros}/lib:/home/ada/lib",
        "PATH": f"/home/ada/bin:{ros}/bin:/usr/bin",
        "LD_PRELOAD": "x.so",
        "LC_ALL": "C.UTF-8",
        "ROS_DOMAIN_ID": "3",
    }
    environment, paths = checker_environment.of_checker(start, None)
    assert paths == [f"{ros}/lib/python3.12/site-packages"]
    assert environment == {
        "HOME": "/home/ada",
        "ROS_DISTRO": "jazzy",
        "AMENT_PREFIX_PATH": str(ros),
        "LD_LIBRARY_PATH": f"{ros}/lib",
        "PATH": f"{ros}/bin:{checker_environment.SYSTEM}",
        "LC_ALL": "C.UTF-8",
        "ROS_DOMAIN_ID": "3",
    }
    assert checker_environment.of_checker(start, 9)[0]["ROS_DOMAIN_ID"] == "9"
