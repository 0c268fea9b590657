"""Beside a sourced ROS 2 Jazzy from apt: the course uses it, and installs and imports no wheel of ROS 2.

apt's installation is imitated by the contents of this environment's wheels in a folder opt/ros/jazzy, which only
the variables that its setup.bash would set lead to.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from importlib.metadata import distributions
from pathlib import Path
from subprocess import CompletedProcess

import pytest

from course_kit.setup.environment.activation import sourced_ros
from tests.course_copy import BASE_PYTHON, CourseCopy, fresh_environ

pytestmark = [
    pytest.mark.slow,
    pytest.mark.timeout(900),
    pytest.mark.skipif(sourced_ros(os.environ) is not None, reason="needs the wheels; here apt's ROS 2 is sourced"),
]
OF_ROS = ("ros-", "ros2-notebook-course")
APTS_COMMAND = "the ros2 of apt"
SITE_PACKAGES = f"lib/python{sys.version_info[0]}.{sys.version_info[1]}/site-packages"


def imitate_apt(prefix: Path) -> dict[str, str]:
    """Fill `prefix` as apt fills /opt/ros/jazzy; return the variables that its setup.bash sets."""
    libraries = [prefix / "lib"]
    for distribution in distributions():
        if not distribution.metadata["Name"].startswith(OF_ROS):
            continue
        for file in distribution.files or ():
            source = Path(os.path.normpath(file.locate()))
            relative = source.relative_to(sys.prefix)
            metadata = ".dist-info" in str(relative) or source.suffix in (".pth", ".pyc")
            ours = "course_" in str(relative) or relative == Path("bin/ros2")
            if metadata or ours or relative.parts[0] == "etc":
                continue
            target = prefix / relative
            target.parent.mkdir(parents=True, exist_ok=True)
            if not target.exists():
                shutil.copy2(source, target)
            if target.parent.suffix == ".libs" and target.parent not in libraries:
                libraries.append(target.parent)
    (prefix / "share/ament_index/resource_index/packages/ros2cli").touch()
    command = prefix / "bin/ros2"
    command.parent.mkdir(exist_ok=True)
    command.write_text(f"#!/bin/sh\necho {APTS_COMMAND}\n")
    command.chmod(0o755)
    return {
        "AMENT_PREFIX_PATH": str(prefix),
        "LD_LIBRARY_PATH": os.pathsep.join(map(str, libraries)),
        "PYTHONPATH": str(prefix / SITE_PACKAGES),
        "ROS_DISTRO": "jazzy",
        "ROS_VERSION": "2",
    }


@pytest.fixture(scope="module")
def apt(tmp_path_factory) -> Iterator[Path]:
    root = tmp_path_factory.mktemp("root")
    yield root / "opt/ros/jazzy"
    shutil.rmtree(root / "opt", ignore_errors=True)


@pytest.fixture(scope="module")
def sourced(apt) -> dict[str, str]:
    """A terminal in which the imitated installation is sourced."""
    environ = fresh_environ(PYTHON=BASE_PYTHON, **imitate_apt(apt))
    return environ | {"PATH": os.pathsep.join([str(apt / "bin"), environ["PATH"]])}


@pytest.fixture(scope="module")
def course(tmp_path_factory) -> Iterator[CourseCopy]:
    copy = CourseCopy(tmp_path_factory.mktemp("beside-apt"))
    yield copy
    copy.remove()


@pytest.fixture(scope="module")
def before(course, sourced) -> dict[str, dict]:
    """What the check says before set-up."""
    return {c["name"]: c for c in json.loads(course.run("--json", environ=sourced).stdout)["checks"]}


@pytest.fixture(scope="module")
def set_up(course, sourced, before) -> CompletedProcess[str]:
    result = course.run("lab", "--version", environ=sourced, timeout=600)
    assert result.returncode == 0, result.stderr
    return result


def test_the_check_announces_apts_ros(before, apt):
    assert before["ROS 2"]["detail"] == f"Jazzy from {apt}, and the course will use it"
    assert before["sourced ROS"]["status"] == "PASS"
    assert before["compiler"]["status"] == "PASS"


def test_set_up_says_which_ros_it_uses_and_installs_no_wheel_of_ros(course, set_up, apt):
    assert f"Using the ROS 2 in {apt}." in set_up.stderr
    installed = {path.name for path in course.root.glob(".venv/lib/python3.*/site-packages/*")}
    assert [name for name in installed if name.startswith(("ros_", "rclpy", "turtlesim", "example_interf"))] == []
    assert any(name.startswith("jupyterlab-") for name in installed)


def test_the_kernel_has_the_courses_name(course, set_up):
    kernel = json.loads((course.root / ".venv/share/jupyter/kernels/python3/kernel.json").read_text())
    assert kernel["display_name"] == "ROS 2 Jazzy (course)"


def test_rclpy_and_the_interfaces_are_imported_from_apt(course, set_up, sourced, apt):
    program = "import rclpy, turtlesim.msg, example_interfaces.srv as e; print(rclpy.__file__, e.__file__)"
    command = [course.root / ".venv/bin/python", "-c", program]
    result = subprocess.run(command, env=sourced, capture_output=True, text=True, timeout=60, check=True)
    assert all(Path(file).is_relative_to(apt) for file in result.stdout.split())
    assert len(result.stdout.split()) == 2


def test_the_ros2_command_is_apts_with_nothing_of_ours_in_between(course, set_up, sourced):
    assert not (course.root / ".venv/bin/ros2").exists()
    program = "import subprocess; subprocess.run(['ros2', 'topic', 'list'], check=True)"
    command = [course.root / ".venv/bin/python", "-c", program]
    result = subprocess.run(command, env=sourced, capture_output=True, text=True, timeout=60, check=True)
    assert result.stdout == f"{APTS_COMMAND}\n"


def test_the_robot_and_its_navigation_are_packages_all_the_same(course, set_up, sourced, apt):
    program = (
        "from ament_index_python.packages import get_package_prefix as prefix\n"
        "print(*map(prefix, ('course_robot', 'course_navigation', 'tf2_ros', 'turtlesim')), sep='\\n')"
    )
    command = [course.root / ".venv/bin/python", "-c", program]
    result = subprocess.run(command, env=sourced, capture_output=True, text=True, timeout=60, check=True)
    assert result.stdout.splitlines() == [str(course.root / ".venv")] * 2 + [str(apt)] * 2


def test_no_library_of_ros_comes_from_anywhere_else(course, set_up, sourced, apt):
    program = (
        "import rclpy; from std_msgs.msg import String; rclpy.init(); "
        "node = rclpy.create_node('libraries'); node.create_publisher(String, 'chatter', 10); "
        "print(open('/proc/self/maps').read())"
    )
    command = [course.root / ".venv/bin/python", "-c", program]
    result = subprocess.run(command, env=sourced, capture_output=True, text=True, timeout=60, check=True)
    loaded = {line.split(maxsplit=5)[5] for line in result.stdout.splitlines() if ".so" in line}
    ros = {path for path in loaded if Path(path).name.startswith(("librcl", "librmw", "libfastrtps", "librosidl"))}
    assert len(ros) > 20
    assert {path for path in ros if not Path(path).is_relative_to(apt)} == set()


def test_afterwards_the_check_passes_with_apts_ros(course, set_up, sourced, apt):
    result = course.run("--json", environ=sourced)
    checks = {check["name"]: check for check in json.loads(result.stdout)["checks"]}
    assert [check for check in checks.values() if check["status"] == "FAIL"] == []
    assert checks["ROS 2"]["detail"] == f"Jazzy from {apt}"
    assert "message after" in checks["ROS 2 node"]["detail"]
    assert checks["environment"]["status"] == "PASS"


def test_unsourced_the_same_folder_asks_for_a_new_set_up(course, set_up):
    checks = {check["name"]: check for check in json.loads(course.run("--json").stdout)["checks"]}
    assert checks["environment"]["status"] == "WARN"
    assert "another" in checks["environment"]["detail"]
