"""The checker's own types: compiled once, the same as what the exercises ask for, none from a workspace."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from course_kit.base import file_locks
from course_kit.exercises.checker import own_types
from tests.kernel import Kernel

USE = """
import pathlib, sys
from course_kit.exercises.checker import own_types
own_types.base = lambda: pathlib.Path(sys.argv[1])
own_types.provide("my_interfaces")
from my_interfaces.action import Polygon
print(Polygon.Goal().sides)
"""


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "kept"
    monkeypatch.setattr(own_types, "base", lambda: folder)
    return folder


def test_types_are_compiled_once(cache: Path):
    assert not own_types.is_ready("my_interfaces")
    command = [sys.executable, "-c", USE, str(cache)]
    used = [subprocess.run(command, capture_output=True, text=True, timeout=180) for _ in range(2)]
    assert [one.stdout for one in used] == ["5\n", "5\n"], used[0].stderr
    assert own_types.is_ready("my_interfaces")
    assert sorted(path.suffix for path in cache.iterdir()) == ["", ".lock"]


def test_what_cannot_be_compiled_is_said(cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (tmp_path / "msg").mkdir()
    (tmp_path / "msg/Bad.msg").write_text("float33 voltage\n")
    monkeypatch.setitem(own_types.DEFINITIONS, "bad_interfaces", (tmp_path, ("msg/Bad.msg",)))
    with pytest.raises(own_types.Uncompiled, match=r"compiling the types of bad_interfaces failed: .+"):
        own_types.provide("bad_interfaces")
    assert [path.suffix for path in cache.iterdir()] == [".lock"]


def test_who_compiles_for_ever_is_not_waited_for_without_end(cache: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(own_types, "LOCK_TIMEOUT", 0.1)
    lock = own_types.folder_of("my_interfaces", own_types.own_texts("my_interfaces")).with_suffix(".lock")
    said = rf"the types of my_interfaces cannot be compiled: another process has kept the lock '{lock}' for 0\.1 s"
    with file_locks.locked(lock, 1.0), pytest.raises(own_types.Uncompiled, match=said):
        own_types.provide("my_interfaces")


def test_the_definitions_are_those_of_the_exercise():
    folder, files = own_types.DEFINITIONS["robot_interfaces"]
    assert [(folder / file).read_text().splitlines() for file in files] == [
        ["float32 EMPTY_VOLTAGE=11.0", "float32 voltage", "float32 percentage", "bool charging"],
        ["float32 percentage", "---", "bool accepted", "string reason"],
    ]


def test_the_checker_loads_nothing_from_a_workspace(tmp_path: Path):
    (tmp_path / "rclpy.py").write_text("raise RuntimeError('from the workspace')\n")
    kernel = Kernel()
    try:
        kernel.run("from course_kit import check")
        paths = f"COLCON_PREFIX_PATH={str(tmp_path)!r}, PYTHONPATH={str(tmp_path)!r}"
        kernel.run(f"import os; os.environ.update({paths})")
        assert "not begun" in kernel.text(kernel.run('check("topics-1")', 60))
    finally:
        kernel.close()
