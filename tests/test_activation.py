"""The environment that every Python of the course has without sourcing anything."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from course_kit.setup.environment import pins, user_domain
from course_kit.setup.environment.activation import PROFILE, activate, sourced_ros

WHEELS = not sourced_ros(os.environ)


def python(code: str, **environ: str) -> str:
    """What a fresh Python of this environment prints, started with almost nothing in its environment."""
    clean = {"PATH": "/usr/bin:/bin", "HOME": os.environ.get("HOME", "/"), **environ}
    done = subprocess.run([sys.executable, "-c", code], env=clean, capture_output=True, text=True, timeout=30)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def variable(name: str, **environ: str) -> str:
    return python(f"import os; print(os.environ.get({name!r}))", **environ)


@pytest.mark.skipif(not WHEELS, reason="a sourced ROS 2 is used, it has its own environment")
def test_a_fresh_python_finds_ros_and_its_packages():
    code = "import rclpy; from ament_index_python.packages import get_package_prefix as p; print(p('turtlesim'))"
    assert python(code) == sys.prefix


def test_a_fresh_python_stays_on_this_machine_in_a_domain_of_its_user():
    assert variable("ROS_AUTOMATIC_DISCOVERY_RANGE") == "LOCALHOST"
    assert variable("ROS_DOMAIN_ID") == user_domain.take(os.getuid())
    assert variable("FASTRTPS_DEFAULT_PROFILES_FILE") == PROFILE
    assert variable("PATH").startswith(str(Path(sys.prefix, "bin")) + os.pathsep)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET"),
        ("ROS_DOMAIN_ID", "42"),
        ("FASTRTPS_DEFAULT_PROFILES_FILE", "/etc/mine.xml"),
    ],
)
def test_what_the_user_set_is_kept(name, value):
    assert variable(name, **{name: value}) == value


@pytest.mark.skipif(not WHEELS, reason="a sourced ROS 2 is used, its CMake files need no correction")
def test_cmake_is_told_about_the_wheels_and_what_the_user_set_is_kept():
    toolchain = Path(variable("CMAKE_TOOLCHAIN_FILE"))
    assert toolchain.is_relative_to(sys.prefix) and toolchain.exists()
    assert variable("CMAKE_TOOLCHAIN_FILE", CMAKE_TOOLCHAIN_FILE="/etc/mine.cmake") == "/etc/mine.cmake"
    assert variable("CMAKE_PREFIX_PATH", CMAKE_PREFIX_PATH="/mine") == f"/mine{os.pathsep}{sys.prefix}"
    assert variable("CMAKE_GENERATOR", PATH="/nowhere") == "Ninja"  # there is no make
    assert variable("CMAKE_GENERATOR", PATH="/nowhere", CMAKE_GENERATOR="Unix Makefiles") == "Unix Makefiles"


@pytest.mark.skipif(not WHEELS, reason="a sourced ROS 2 is used, it is the underlay of workspaces")
@pytest.mark.parametrize("shell", ["bash", "zsh"])
def test_sourcing_local_setup_gives_a_shell_what_every_python_has(shell):
    if shutil.which(shell) is None:
        pytest.skip(f"{shell} is not installed")
    code = f"source '{sys.prefix}/local_setup.{shell}'; echo \"$ROS_AUTOMATIC_DISCOVERY_RANGE\"; command -v python"
    clean = {"PATH": "/usr/bin:/bin", "HOME": os.environ.get("HOME", "/")}
    done = subprocess.run([shell, "-c", code], env=clean, capture_output=True, text=True, timeout=30)
    assert (done.stdout.splitlines(), done.stderr) == (["LOCALHOST", str(Path(sys.prefix, "bin/python"))], "")


def test_a_users_profile_in_the_newer_variable_wins_too():
    kept = variable("FASTRTPS_DEFAULT_PROFILES_FILE", FASTDDS_DEFAULT_PROFILES_FILE="/etc/mine.xml")
    assert kept == "None"


@pytest.mark.parametrize(("value", "profile"), [("SUBNET", PROFILE), ("OFF", PROFILE), ("", PROFILE), ("home", "None")])
def test_a_range_that_there_is_not_is_left_to_ros(value, profile):
    assert variable("FASTRTPS_DEFAULT_PROFILES_FILE", ROS_AUTOMATIC_DISCOVERY_RANGE=value) == profile
    assert variable("ROS_AUTOMATIC_DISCOVERY_RANGE", ROS_AUTOMATIC_DISCOVERY_RANGE=value) == (value or "LOCALHOST")


@pytest.mark.parametrize(("value", "expected"), [("1", "LOCALHOST"), ("0", "SUBNET"), ("", "LOCALHOST")])
def test_ros_localhost_only_is_not_contradicted(value, expected):
    assert variable("ROS_AUTOMATIC_DISCOVERY_RANGE", ROS_LOCALHOST_ONLY=value) == expected


def test_a_childs_domain_is_that_of_its_parent_unless_the_user_set_one():
    assert variable("ROS_DOMAIN_ID", ROS_DOMAIN_ID="7", COURSE_KIT_DOMAIN="7") == "7"
    assert variable("ROS_DOMAIN_ID", ROS_DOMAIN_ID="8", COURSE_KIT_DOMAIN="7") == "8"
    assert variable("COURSE_KIT_DOMAIN", ROS_DOMAIN_ID="8") == "None"


@pytest.mark.skipif(not WHEELS, reason="a sourced ROS 2 is used, nothing has to be kept apart from it")
def test_a_sourced_ros_does_not_mix_with_the_wheels(tmp_path):
    prefix = tmp_path / "opt/ros/humble"
    marker = prefix / "share/ament_index/resource_index/packages/rclpy"
    marker.parent.mkdir(parents=True)
    marker.touch()
    modules = prefix / "lib/python3/site-packages"
    (modules / "rclpy").mkdir(parents=True)
    (modules / "rclpy/__init__.py").write_text("raise ImportError('the wrong rclpy')")
    sourced = {
        "AMENT_PREFIX_PATH": str(prefix),
        "PYTHONPATH": str(modules),
        "LD_LIBRARY_PATH": str(prefix / "lib"),
        "ROS_DISTRO": "humble",
    }
    code = "import os, rclpy; print(rclpy.__file__, os.environ['LD_LIBRARY_PATH'], os.environ['AMENT_PREFIX_PATH'])"
    printed = python(code, **sourced)
    assert str(prefix) not in printed and sys.prefix in printed


def test_beside_a_sourced_ros_the_courses_own_packages_are_found_last(tmp_path):
    index = tmp_path / "venv/share/ament_index/resource_index/packages"
    index.mkdir(parents=True)
    (index / "course_robot").touch()
    prefix = str(tmp_path / "venv")
    environ = {"AMENT_PREFIX_PATH": "/opt/ros/jazzy", "ROS_DOMAIN_ID": "42"}
    for _ in range(2):
        activate(prefix, environ)
        assert environ["AMENT_PREFIX_PATH"] == f"/opt/ros/jazzy:{prefix}"
    assert "CMAKE_PREFIX_PATH" not in environ


def test_activating_twice_changes_nothing_more():
    environ = {"PATH": "/usr/bin", "AMENT_PREFIX_PATH": "/my/workspace/install"}
    activate(environ=environ)
    once = dict(environ)
    activate(environ=environ)
    assert environ == once
    assert environ["AMENT_PREFIX_PATH"].split(os.pathsep)[0] == "/my/workspace/install"


def test_every_pin_is_exact_and_without_ros_none_of_ros_is_left():
    everything, without = pins.requirements(with_ros=True), pins.requirements(with_ros=False)
    assert all("==" in requirement for requirement in everything)
    assert not [requirement for requirement in without if requirement.startswith(("ros-", "cmake==", "ninja=="))]
    assert {r for r in everything if not r.startswith(("ros-", "cmake==", "ninja=="))} == set(without)
    assert any(requirement.startswith("colcon-core==") for requirement in without)
    assert "--hash=sha256:" in pins.LOCK.read_text() and "://" not in pins.LOCK.read_text()
