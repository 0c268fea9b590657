"""environment-check.sh before anything is set up: it reports, cures nothing by itself and changes nothing."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.course_copy import BASE_PYTHON, ROOT, CourseCopy, fresh_environ


@pytest.fixture(scope="module")
def course(tmp_path_factory) -> CourseCopy:
    """The course as after `git clone`."""
    return CourseCopy(tmp_path_factory.mktemp("clone"))


@pytest.fixture(scope="module")
def answer(course, tmp_path_factory) -> dict:
    """The JSON report of the clone, made with an empty home."""
    home = tmp_path_factory.mktemp("home")
    before = course.files()
    result = course.run("--json", environ=fresh_environ(PYTHON=BASE_PYTHON, HOME=str(home)))
    assert course.files() == before, "checking must change nothing"
    assert list(home.iterdir()) == [], "checking must change nothing in the user's home either"
    return json.loads(result.stdout) | {"exit status": result.returncode}


def by_name(answer: dict) -> dict[str, dict]:
    return {check["name"]: check for check in answer["checks"]}


def without_python(folder: Path) -> str:
    """A PATH with the usual commands and no Python."""
    for command in ("bash", "dirname", "ls", "mkdir", "realpath", "uname"):
        (folder / command).symlink_to(str(shutil.which(command)))
    return str(folder)


def test_what_set_up_will_bring_is_a_warning_that_names_it(answer):
    checks = by_name(answer)
    for name in ("environment", "ROS 2", "ROS 2 node", "JupyterLab", "widgets"):
        assert (checks[name]["status"], checks[name]["cure"]) == ("WARN", "./environment-check.sh lab")


def test_a_machine_that_can_run_the_tests_has_no_failure_before_set_up(answer):
    assert [check for check in answer["checks"] if check["status"] == "FAIL"] == []
    assert answer["ok"] is True
    assert answer["exit status"] == 0


def test_the_table_says_the_same_as_the_json(course, answer):
    lines = course.run().stdout.splitlines()
    rows = [line for line in lines if line.startswith(("PASS", "WARN", "FAIL"))]
    assert [row.split()[0] for row in rows] == [check["status"] for check in answer["checks"]]
    assert lines[-1] == "Next: ./environment-check.sh lab, to set it up and start the course."


def test_a_failure_gives_exit_status_1_and_the_cure(course):
    result = course.run(environ=fresh_environ(PYTHON=BASE_PYTHON, ROS_DOMAIN_ID="300"))
    assert result.returncode == 1
    assert "cure: export ROS_DOMAIN_ID=" in result.stdout


def test_another_sourced_distribution_is_reported(course, tmp_path):
    prefix = tmp_path / "opt/ros/humble"
    (prefix / "share/ament_index/resource_index/packages").mkdir(parents=True)
    (prefix / "share/ament_index/resource_index/packages/rclpy").touch()
    sourced = {
        "AMENT_PREFIX_PATH": str(prefix),
        "PYTHONPATH": f"{prefix}/lib/python3.10/site-packages",
        "LD_LIBRARY_PATH": f"{prefix}/lib",
        "ROS_DISTRO": "humble",
        "RMW_IMPLEMENTATION": "rmw_cyclonedds_cpp",
    }
    result = course.run("--json", environ=fresh_environ(PYTHON=BASE_PYTHON, **sourced))
    checks = by_name(json.loads(result.stdout))
    assert checks["sourced ROS"]["status"] == "WARN"
    assert f"{prefix}/setup.bash" in checks["sourced ROS"]["cure"]
    assert checks["PYTHONPATH"]["status"] == "PASS"  # the same cause is not reported twice
    assert checks["RMW_IMPLEMENTATION"]["status"] == "FAIL"
    assert result.returncode == 1


def test_without_any_python_it_says_what_to_install(course, tmp_path):
    environ = fresh_environ(PATH=without_python(tmp_path))
    table = course.run(environ=environ)
    assert table.returncode == 1
    assert table.stdout.startswith("FAIL  Python ")
    assert "cure: sudo apt-get install -y python3" in table.stdout
    checks = json.loads(course.run("--json", environ=environ).stdout)["checks"]
    assert [(check["name"], check["status"]) for check in checks] == [("Python", "FAIL")]
    lab = course.run("lab", environ=environ)
    assert lab.returncode == 1
    assert "sudo apt-get install -y python3" in lab.stderr


def test_a_python_that_is_not_there_is_named(course):
    result = course.run("lab", environ=fresh_environ(PYTHON="/no/such/python3.12"))
    assert result.returncode == 1
    assert "PYTHON=/no/such/python3.12" in result.stderr
    assert not (course.root / ".venv").exists()


@pytest.mark.parametrize("version", ["3, 9, 18", "3, 15, 0"])
def test_a_python_that_is_too_old_or_too_new_is_refused_with_a_cure_that_brings_another(course, tmp_path, version):
    program = f"import runpy, sys; sys.version_info = ({version}, 'final', 0); sys.argv = sys.argv[1:]; "
    program += "runpy.run_module(sys.argv[0], run_name='__main__')"
    python = tmp_path / "python3"
    # -c and the program take the place of -m in `python -ESB -m module argument...`.
    python.write_text(f'#!/bin/sh\nshift 2\nexec "{BASE_PYTHON}" -ESB -c "{program}" "$@"\n')
    python.chmod(0o755)
    environ = fresh_environ(PATH=without_python(tmp_path))
    cure = "pipx run uv python install 3.14 && PYTHON=~/.local/bin/python3.14 ./environment-check.sh lab"
    checked = course.run("--json", environ=environ)
    assert checked.returncode == 1
    (found,) = [check for check in json.loads(checked.stdout)["checks"] if check["name"] == "Python"]
    assert found["status"] == "FAIL"
    assert found["cure"].endswith(cure)
    lab = course.run("lab", environ=environ)
    assert lab.returncode == 1
    assert lab.stderr.strip().endswith(cure)
    assert not (course.root / ".venv").exists()
    named = course.run("lab", environ=environ | {"PYTHON": str(python)})
    assert "unset PYTHON" in named.stderr  # perhaps there is one that fits


def test_a_python_that_does_not_run_is_passed_over_and_condas_comes_last(course, tmp_path):
    for name in ("conda", "plain", "commands"):
        (tmp_path / name).mkdir()
    (tmp_path / "conda/python3").symlink_to(BASE_PYTHON)
    (tmp_path / "plain/python3").symlink_to(BASE_PYTHON)
    (tmp_path / "plain/python3.12").write_text("#!/bin/sh\necho no such version >&2\nexit 1\n")  # a shim of pyenv
    (tmp_path / "plain/python3.12").chmod(0o755)
    folders = [str(tmp_path / "conda"), str(tmp_path / "plain"), without_python(tmp_path / "commands")]
    environ = fresh_environ(PATH=os.pathsep.join(folders), CONDA_PREFIX=folders[0])
    checks = by_name(json.loads(course.run("--json", environ=environ).stdout))
    assert f"({tmp_path}/plain/python3)" in checks["Python"]["detail"]
    assert checks["conda"]["status"] == "WARN"


@pytest.mark.parametrize("lacking", ["venv", "dev"])
def test_a_python_without_its_debian_packages_names_them(course, tmp_path, lacking):
    """Debian's python3 without python3-venv or python3-dev, imitated by one that hides what they install."""
    hide = {
        "venv": "import importlib.util as u; find = u.find_spec; "
        "u.find_spec = lambda name, *a: None if name == 'ensurepip' else find(name, *a)",
        "dev": "import sysconfig as s; path = s.get_path; "
        "s.get_path = lambda name, *a, **k: '/nowhere' if name == 'include' else path(name, *a, **k)",
    }[lacking]
    program = f"{hide}; import sys, runpy; sys.argv = sys.argv[1:]; runpy.run_module(sys.argv[0], run_name='__main__')"
    python = tmp_path / "python3"
    # -c and the program take the place of -m in `python -ESB -m module argument...`.
    python.write_text(f'#!/bin/sh\nshift 2\nexec "{BASE_PYTHON}" -ESB -c "{program}" "$@"\n')
    python.chmod(0o755)
    path = os.pathsep.join(p for p in fresh_environ()["PATH"].split(os.pathsep) if not Path(p, "uv").exists())
    result = course.run("lab", environ=fresh_environ(PYTHON=str(python), PATH=path))
    assert result.returncode == 1
    assert f"sudo apt-get install -y python3.{sys.version_info[1]}-{lacking}" in result.stderr
    assert not (course.root / ".venv").exists()


def test_somebody_elses_venv_is_left_alone(tmp_path):
    course = CourseCopy(tmp_path)
    (course.root / ".venv").mkdir()
    (course.root / ".venv/pyvenv.cfg").write_text("home = /usr/bin\n")
    result = course.run("lab")
    assert result.returncode == 1
    assert "mv .venv .venv-mine" in result.stderr
    assert (course.root / ".venv/pyvenv.cfg").read_text() == "home = /usr/bin\n"


@pytest.mark.parametrize("arguments", [(), ("--json",), ("lab",), ("test",)])
def test_macos_gets_a_clear_answer_and_no_apt(course, tmp_path, arguments):
    (tmp_path / "uname").write_text("#!/bin/sh\necho Darwin\n")
    (tmp_path / "uname").chmod(0o755)
    result = course.run(*arguments, environ=fresh_environ(PATH=f"{tmp_path}:{os.environ['PATH']}"))
    assert result.returncode == 1
    assert "Darwin" in result.stdout and "virtual machine" in result.stdout
    assert "apt-get" not in result.stdout + result.stderr
    if arguments == ("--json",):
        assert [check["name"] for check in json.loads(result.stdout)["checks"]] == ["operating system"]


def test_an_arm_machine_is_told_of_apt_before_anything_is_set_up(tmp_path):
    course = CourseCopy(tmp_path)
    (tmp_path / "sitecustomize.py").write_text("import platform\nplatform.machine = lambda: 'aarch64'\n")
    python = tmp_path / "python3"  # which leaves -E and -S away, with which Python would not read that file
    python.write_text(f'#!/bin/sh\nshift\nPYTHONPATH="{tmp_path}" exec "{BASE_PYTHON}" -B "$@"\n')
    python.chmod(0o755)
    result = course.run("lab", environ=fresh_environ(PYTHON=str(python)))
    assert result.returncode == 1
    assert len(result.stderr.splitlines()) <= 5
    assert "FAIL  architecture  aarch64" in result.stderr
    assert "sudo apt-get install -y ros-jazzy-ros-base" in result.stderr
    assert not (course.root / ".venv").exists()


def test_help_and_a_wrong_argument_show_the_usage(course):
    assert course.run("--help").stdout.startswith("Usage: ./environment-check.sh")
    wrong = course.run("laboratory")
    assert wrong.returncode == 2
    assert "unknown argument: laboratory" in wrong.stderr


def test_it_runs_with_another_shell_than_bash(course):
    result = subprocess.run(
        ["sh", course.root / "environment-check.sh", "--help"], capture_output=True, text=True, timeout=30, check=True
    )
    assert result.stdout.startswith("Usage:")


@pytest.mark.skipif(not shutil.which("shellcheck"), reason="needs shellcheck: sudo apt-get install -y shellcheck")
@pytest.mark.parametrize("script", ["environment-check.sh", ".ci/run"])
def test_shell_scripts_are_clean(script):
    result = subprocess.run(["shellcheck", ROOT / script], capture_output=True, text=True, timeout=60, check=False)
    assert result.stdout == ""
