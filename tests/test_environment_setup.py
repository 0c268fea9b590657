"""environment-check.sh lab and test, for real: interrupted, twice at once, going up; JupyterLab, the tests."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from dataclasses import dataclass
from subprocess import CompletedProcess
from urllib.parse import urlsplit

import pytest

from course_kit.setup.environment import levels, stamp
from tests.course_copy import ROOT, CourseCopy, fresh_environ
from tests.waiting import wait_until

pytestmark = [pytest.mark.cpu_bound, pytest.mark.slow, pytest.mark.timeout(900)]
SET_UP_TIMEOUT = 600.0  # a slow network, no cache
TYPES = ".mypy_cache"  # what mypy has found out; without it each of its runs takes most of a minute


@dataclass
class SetUp:
    """A course that was set up after an interruption, by two commands at the same time."""

    course: CourseCopy
    state_after_kill: str
    first: CompletedProcess
    second: CompletedProcess


@pytest.fixture(scope="module")
def done(tmp_path_factory) -> Iterator[SetUp]:
    course = CourseCopy(tmp_path_factory.mktemp("set-up"))
    if (ROOT / TYPES).is_dir():
        shutil.copytree(ROOT / TYPES, course.root / TYPES)
    for path in (course.root / "tests").glob("test_*.py"):
        path.unlink()
    interrupted = course.start("lab", "--version")
    wait_until(
        lambda: any(course.root.glob(".venv/lib/python3.*/site-packages/*/__init__.py")),
        "the first packages",
        SET_UP_TIMEOUT,
    )
    os.killpg(interrupted.pid, signal.SIGKILL)
    interrupted.communicate()
    state = course.run("--json").stdout
    commands = [course.start("lab", "--version") for _ in range(2)]
    results = []
    for command in commands:
        output, errors = command.communicate(timeout=SET_UP_TIMEOUT)
        results.append(CompletedProcess(command.args, command.returncode, output, errors))
    yield SetUp(course, state, *results)
    course.remove()


def test_an_interrupted_set_up_is_reported_and_the_next_start_makes_it_anew(done):
    report = {check["name"]: check for check in json.loads(done.state_after_kill)["checks"]}
    assert report["environment"]["status"] == "WARN"
    assert "interrupted" in report["environment"]["detail"]
    assert stamp.read(done.course.root / ".venv")[0] != stamp.UNFINISHED


def test_of_two_set_ups_at_once_one_works_and_the_other_waits(done):
    for result in (done.first, done.second):
        assert result.returncode == 0, result.stderr
        assert re.fullmatch(r"\d+\.\d+\.\d+\n", result.stdout)  # the answer of `jupyter-lab --version`
    messages = done.first.stderr + done.second.stderr
    assert messages.count("Set up in ") == 1
    assert messages.count("Another set-up of this course is running") == 1


def test_afterwards_every_check_passes_and_nothing_is_changed(done, tmp_path):
    before = done.course.files()
    result = done.course.run("--json", environ=fresh_environ(HOME=str(tmp_path)))
    assert result.returncode == 0
    report = json.loads(result.stdout)
    assert [check for check in report["checks"] if check["status"] == "FAIL"] == []
    found = {check["name"]: check["detail"] for check in report["checks"]}
    assert "message after" in found["ROS 2 node"]
    assert found["environment"].startswith(".venv with ")
    assert done.course.files() == before
    assert list(tmp_path.iterdir()) == []


def test_the_second_start_sets_nothing_up(done):
    begun = time.monotonic()
    result = done.course.run("lab", "--version")
    assert result.returncode == 0
    assert result.stderr == ""
    assert time.monotonic() - begun < 15  # most of it JupyterLab's own; a set-up takes longer


def get(address: str) -> bytes:
    with urllib.request.urlopen(address, timeout=10) as response:
        return response.read()


def test_lab_serves_the_notebooks_on_localhost_and_only_with_its_token(done, tmp_path):
    environ = fresh_environ(HOME=str(tmp_path))
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER"):
        environ.pop(name, None)
    server = done.course.start("lab", environ=environ)
    try:
        lines = iter(server.stdout.readline, "")
        address = next(line.split()[-1] for line in lines if "Its address: " in line)
        parts = urlsplit(address)
        assert (parts.hostname, parts.path) == ("127.0.0.1", "/lab/tree/0_start.ipynb")
        assert re.fullmatch(r"token=\w{40,}", parts.query)
        assert b"JupyterLab" in get(address)
        contents = f"http://127.0.0.1:{parts.port}/api/contents"
        with pytest.raises(urllib.error.HTTPError, match="403"):
            get(contents)
        names = {entry["name"] for entry in json.loads(get(f"{contents}?{parts.query}"))["content"]}
        assert names == {path.name for path in (done.course.root / "notebooks").iterdir()}
        with urllib.request.urlopen(f"http://127.0.0.1:{parts.port}/?{parts.query}", timeout=10) as response:
            assert urlsplit(response.url).path == parts.path  # where a browser is sent that `lab` opens itself
        with pytest.raises(OSError, match="refused"):  # another address of this machine
            get(f"http://127.0.0.2:{parts.port}/")
    finally:
        os.killpg(server.pid, signal.SIGTERM)
        server.communicate(timeout=30)


def test_the_first_grading_adds_what_it_needs_to_what_lab_has_set_up(done):
    assert not (done.course.root / ".venv/bin/dask").exists()
    command = [".venv/bin/course", "grade", ".", "--only", "topics-2"]
    results = [
        subprocess.run(command, cwd=done.course.root, env=fresh_environ(), capture_output=True, text=True, timeout=300)
        for _ in range(2)
    ]
    assert [result.returncode for result in results] == [1, 1], results  # not all points
    assert all("topics-2 · Why does nothing arrive?: not begun" in result.stdout for result in results)
    assert results[0].stderr.count("Adding to .venv what `course grade` needs") == 1
    assert "Adding" not in results[1].stderr
    assert stamp.level_of(done.course.root / ".venv") == levels.GRADING
    again = done.course.run("lab", "--with-grading", "--version")
    assert (again.returncode, again.stderr) == (0, "")


def test_the_tests_run_after_lint_and_a_lint_error_fails_them(done):
    (done.course.root / "tests/test_lint_error.py").write_text("import os\n\n\ndef test_good():\n    assert True\n")
    result = done.course.run("test", "tests/test_lint_error.py", "-q", timeout=300)
    assert result.returncode != 0
    assert "F401" in result.stdout
    assert "Adding to .venv what the tests need" in result.stderr
    assert result.stdout.splitlines()[-1].startswith("1 passed")


def test_a_failing_test_fails_the_command(done):
    (done.course.root / "tests/test_bad.py").write_text("def test_bad():\n    assert 1 == 2\n")
    result = done.course.run("test", "tests/test_bad.py", "-q", timeout=300)
    assert result.returncode == 1
    assert result.stdout.splitlines()[-1].startswith("1 failed")


def test_none_of_this_has_changed_a_notebook(done):
    for path in (ROOT / "notebooks").glob("*.ipynb"):
        assert (done.course.root / "notebooks" / path.name).read_bytes() == path.read_bytes()
