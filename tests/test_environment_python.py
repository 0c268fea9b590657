"""Checks of Python, and the stamp that tells whether .venv fits."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from course_kit.setup.environment import interpreter, stamp
from course_kit.setup.environment.activation import RosInstallation
from course_kit.setup.environment.checks import python
from course_kit.setup.environment.interpreter import Interpreter
from tests.course_copy import BASE_PYTHON, ROOT, CourseCopy


def some_python(version=(3, 11, 7), has_venv=True, has_headers=True, **facts) -> Interpreter:
    return Interpreter("/usr/bin/python3", version, "/usr", has_venv, has_headers, **facts)


@pytest.fixture
def jazzy(tmp_path) -> RosInstallation:
    """The folders of an apt installation of ROS 2 Jazzy for Python 3.12, without turtlesim."""
    prefix = tmp_path / "opt/ros/jazzy"
    (prefix / "lib/python3.12/site-packages/rclpy").mkdir(parents=True)
    packages = prefix / "share/ament_index/resource_index/packages"
    packages.mkdir(parents=True)
    for name in ("rclpy", "example_interfaces"):
        (packages / name).touch()
    return RosInstallation(str(prefix), "jazzy")


@pytest.mark.parametrize(
    ("version", "status"),
    [((3, 9, 18), "FAIL"), ((3, 10, 0), "PASS"), ((3, 14, 0), "PASS"), ((3, 15, 0), "FAIL"), ((2, 7, 18), "FAIL")],
)
def test_python_3_10_to_3_14_runs_the_wheels(version, status):
    assert python.version(some_python(version), ros=None, environ={}).status == status


@pytest.mark.parametrize("version", [(3, 9, 18), (3, 15, 0)])
def test_the_cure_of_a_python_that_does_not_fit_brings_one_that_does(version, tmp_path):
    def cure(**variables: str) -> str:
        return python.version(some_python(version), None, {"PATH": str(tmp_path), **variables}).cure

    brings = "uv python install 3.14 && PYTHON=~/.local/bin/python3.14 ./environment-check.sh lab"
    assert cure() == f"sudo apt-get install -y pipx && pipx run {brings}"
    assert cure(PYTHON="/opt/other/python") == "unset PYTHON; ./environment-check.sh lab"
    (tmp_path / "uv").touch(mode=0o755)
    assert cure() == brings


def test_beside_a_sourced_ros_only_its_own_python_will_do(jazzy):
    assert python.version(some_python((3, 12, 3)), jazzy, {}).status == "PASS"
    check = python.version(some_python((3, 11, 7)), jazzy, {})
    assert check.status == "FAIL"
    assert jazzy.prefix in check.reason
    assert "sudo apt-get install -y python3 " in check.cure


def test_all_places_name_the_same_range_of_pythons():
    (major, oldest), (_, newest) = interpreter.OLDEST, interpreter.NEWEST
    said = f"Python {major}.{oldest} to {major}.{newest}"
    assert (ROOT / "README.md").read_text().count(said) == 2
    script = (ROOT / "environment-check.sh").read_text()
    assert said in script
    assert all(f" python{major}.{minor} " in script for minor in range(oldest, newest + 1))
    project = (ROOT / "pyproject.toml").read_text()
    assert f'requires-python = ">={major}.{oldest},<{major}.{newest + 1}"' in project
    assert f"python_full_version < '{major}.{newest + 1}'" in project


def test_a_missing_venv_module_fails_with_the_package_to_install_until_the_environment_is_made():
    check = python.venv_module(some_python(has_venv=False), ready=False)
    assert (check.status, check.cure) == ("FAIL", "sudo apt-get install -y python3.11-venv")
    assert python.venv_module(some_python(has_venv=False), ready=True).status == "PASS"


def test_missing_headers_fail_with_the_package_to_install_while_interfaces_must_be_compiled():
    check = python.compiler({"CXX": "g++"}, some_python(has_headers=False), ros=None, ready=False)
    assert (check.status, check.cure) == ("FAIL", "sudo apt-get install -y python3.11-dev")
    check = python.compiler({"CXX": "g++"}, some_python(has_headers=False), ros=None, ready=True)
    assert (check.status, check.cure) == ("WARN", "sudo apt-get install -y python3.11-dev")
    assert "chapter 2" in check.reason


def test_without_a_compiler_ziglang_takes_its_place(tmp_path):
    check = python.compiler({"PATH": str(tmp_path)}, some_python(), ros=None, ready=False)
    assert check.status == "WARN"
    assert "ziglang" in check.reason
    brought = some_python(distributions={"ziglang": "0.17.0"})
    assert python.compiler({"PATH": str(tmp_path)}, brought, ros=None, ready=True).status == "PASS"
    check = python.compiler({"PATH": str(tmp_path)}, some_python(), ros=None, ready=True)
    assert (check.status, check.cure) == ("WARN", "sudo apt-get install -y g++")
    assert "chapter 2" in check.reason


def test_a_compiler_on_the_path_passes(tmp_path):
    (tmp_path / "c++").touch(mode=0o755)
    check = python.compiler({"PATH": str(tmp_path)}, some_python(), ros=None, ready=False)
    assert (check.status, check.detail) == ("PASS", str(tmp_path / "c++"))


def test_nothing_is_compiled_that_a_sourced_ros_brings(jazzy):
    assert interpreter.interfaces_to_compile(None) == ["example_interfaces", "nav2_msgs", "tf2_msgs", "turtlesim"]
    assert interpreter.interfaces_to_compile(jazzy) == ["nav2_msgs", "tf2_msgs", "turtlesim"]


def test_nothing_is_installed_that_a_sourced_ros_brings(jazzy):
    assert {"example_interfaces", "tf2_msgs", "tf2_ros_py"} <= set(interpreter.packages_to_install(None))
    Path(jazzy.prefix, "share/ament_index/resource_index/packages/tf2_ros_py").touch()
    beside = interpreter.packages_to_install(jazzy)
    assert "tf2_geometry_msgs" in beside and not {"example_interfaces", "tf2_ros_py"} & set(beside)


def test_an_active_conda_environment_warns():
    assert python.conda({}).status == "PASS"
    check = python.conda({"CONDA_PREFIX": "/opt/conda"})
    assert (check.status, check.cure) == ("WARN", "conda deactivate")


def test_a_foreign_pythonpath_warns_and_one_with_another_rclpy_fails(tmp_path):
    def status(*packages: str) -> str:
        for package in packages:
            (tmp_path / package).mkdir()
        return python.python_path({"PYTHONPATH": str(tmp_path)}).status

    assert status() == "WARN"
    assert status("numpy") == "WARN"
    assert status("rclpy") == "FAIL"


def test_the_pythonpath_of_a_sourced_ros_is_not_foreign(jazzy):
    entry = f"{jazzy.prefix}/lib/python3.12/site-packages"
    sourced = {"PYTHONPATH": f"{entry}:", "AMENT_PREFIX_PATH": f"/home/student/ws/install/talker:{jazzy.prefix}"}
    assert python.python_path(sourced).status == "PASS"


@pytest.mark.parametrize("state", [stamp.MISSING, stamp.UNFINISHED, stamp.OUTDATED])
def test_what_set_up_will_make_is_no_failure(state):
    check = python.set_up(state, some_python())
    assert (check.status, check.cure) == ("WARN", "./environment-check.sh lab")


def test_somebody_elses_venv_is_moved_by_nobody_but_its_owner():
    check = python.set_up(stamp.INCOMPLETE, some_python())
    assert check.status == "FAIL"
    assert check.cure.startswith("mv .venv ")


def test_packages_of_another_version_are_named():
    check = python.set_up(stamp.READY, some_python(unmet=["numpy==2.2.6", "pillow==12.3.0"]))
    assert check.status == "WARN"
    assert "numpy==2.2.6, pillow==12.3.0" in check.detail


def test_the_environment_of_the_tests_has_every_pin():
    found = interpreter.probe(sys.executable, os.environ)
    assert list(found.unmet) == []
    assert found.distributions["pytest"] == pytest.__version__
    assert found.version == sys.version_info[:3]


def test_a_program_that_is_no_python_is_refused():
    with pytest.raises((OSError, ValueError)):
        interpreter.probe("/bin/false", os.environ)


# ---- the stamp

THIS = sys.version_info[:2]


@pytest.fixture
def finished(tmp_path) -> Path:
    """A copy of the course whose .venv carries the stamp of a finished set-up."""
    root = CourseCopy(tmp_path).root
    (root / ".venv").mkdir()
    (root / ".venv" / stamp.NAME).write_text(stamp.digest(root, {}, THIS) + "\n")
    return root


def test_a_finished_venv_is_ready(finished):
    assert stamp.state(finished, {}, THIS) == "ready"


@pytest.mark.parametrize(
    "source",
    [
        "pyproject.toml",
        "course_kit/setup/environment/levels.py",
        "course_kit/setup/environment/requirements.lock",
        "course_kit/setup/environment/prefix/share/course_kit/bashrc.sh",
        "course_kit/setup/interfaces/build_hook.py",
        "course_kit/setup/interfaces/course_kit_environment.pth",
        "course_kit/setup/interfaces/rosidl.py",
        "course_kit/setup/interfaces/turtlesim/msg/Pose.msg",
    ],
)
def test_a_change_in_what_set_up_installs_makes_the_venv_outdated(finished, source):
    with open(finished / source, "a") as file:
        file.write("# changed\n")
    assert stamp.state(finished, {}, THIS) == "outdated"


def test_a_change_in_code_that_is_used_where_it_lies_does_not(finished):
    with open(finished / "course_kit/setup/environment/report.py", "a") as file:
        file.write("# changed\n")
    assert stamp.state(finished, {}, THIS) == "ready"


def test_another_python_makes_the_venv_outdated(finished):
    assert stamp.state(finished, {}, (3, 9)) == "outdated"


def test_sourcing_ros_makes_the_venv_outdated_and_unsourcing_makes_it_ready_again(finished, jazzy):
    sourced = {"AMENT_PREFIX_PATH": jazzy.prefix, "ROS_DISTRO": "jazzy"}
    assert stamp.state(finished, sourced, THIS) == "outdated"
    assert stamp.state(finished, {}, THIS) == "ready"


def test_a_venv_that_was_moved_with_its_folder_is_outdated(finished):
    moved = finished.rename(finished.parent / "elsewhere")
    assert stamp.state(moved, {}, THIS) == "outdated"


def test_the_other_states_of_a_venv(tmp_path):
    venv = tmp_path / ".venv"
    assert stamp.state(tmp_path, {}, THIS) == "missing"
    venv.mkdir()
    assert stamp.state(tmp_path, {}, THIS) == "missing"
    (venv / "pyvenv.cfg").touch()
    assert stamp.state(tmp_path, {}, THIS) == "incomplete"
    (venv / "lib/python3.11/site-packages/ros2_notebook_course-0.1.0.dist-info").mkdir(parents=True)
    assert stamp.state(tmp_path, {}, THIS) == "foreign"
    (venv / stamp.NAME).write_text("unfinished\n")
    assert stamp.state(tmp_path, {}, THIS) == "unfinished"


def test_the_base_python_of_the_tests_is_fit_for_the_course():
    module = [BASE_PYTHON, "-ESB", "-m", "course_kit.setup.environment.interpreter"]
    done = subprocess.run(module, capture_output=True, text=True, cwd=ROOT, env={}, timeout=30)
    assert (done.returncode, done.stdout) == (0, "\n")
