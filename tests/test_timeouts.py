"""A test that is stopped by its time-out ends its process, so that no test after it meets what it has left."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import psutil  # type: ignore[import-untyped]
import pytest

from tests import leftovers
from tests.waiting import wait_until

ROOT = Path(__file__).parents[1]
TESTS = """
import ctypes, os, subprocess, time
import pytest

def waits():
    time.sleep(600)

def holds_the_lock():
    libc, mutex = ctypes.PyDLL(None), ctypes.create_string_buffer(64)
    libc.pthread_mutex_lock(mutex)
    libc.pthread_mutex_lock(mutex)

@pytest.mark.timeout(1)
def test_stopped():
    os.write({pipe}, b"%d stopped %d" % (os.getpid(), subprocess.Popen(["sleep", "600"]).pid))
    {how}()

def test_after_it():
    os.write({pipe}, b", %d after it" % os.getpid())
"""


@pytest.mark.parametrize("how", ["waits", "holds_the_lock"])
def test_its_process_ends_and_the_next_test_has_another(how: str, tmp_path: Path) -> None:
    said = tmp_path / "said"
    text = TESTS.replace("{pipe}", f"os.open({str(said)!r}, os.O_WRONLY | os.O_APPEND | os.O_CREAT)")
    (tmp_path / "test_it.py").write_text(text.replace("{how}", how))
    (tmp_path / "conftest.py").write_text("from tests.conftest import *\n")  # pytest captures while it imports it
    settings = f"-c {ROOT / 'pyproject.toml'} --rootdir {tmp_path} -p no:cacheprovider".split()
    command = [sys.executable, "-m", "pytest", *settings, "-n1", "--dist", "loadgroup", str(tmp_path / "test_it.py")]
    # A run in a run: it reports nothing, and its processes have a mark of their own.
    environ = {**os.environ, "PYTEST_XDIST_WORKER": "gw0", leftovers.MARK: str(tmp_path)}
    done = subprocess.run(command, capture_output=True, text=True, timeout=100, cwd=ROOT, env=environ)
    assert "1 failed, 1 passed" in done.stdout, done.stdout + done.stderr
    assert f"in {how}" in done.stderr  # where it stood
    assert "gw0 ended with 1" in done.stdout
    stopped, after = said.read_text().split(",")
    assert "stopped" in stopped and "after it" in after
    assert stopped.split()[0] != after.split()[0]
    wait_until(lambda: not psutil.pid_exists(int(stopped.split()[-1])))  # its program
