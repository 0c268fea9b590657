"""Sources of a workspace that are handed in beside the notebooks."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from course_kit.classroom.collect import handin_workspace
from course_kit.classroom.collect.handins import HandIn, find
from tests.grading.made_handins import NAMES, TOPICS, in_folder_and_zip, lay, zipped

SOURCES = {"pkg/package.xml": b"<p/>", "pkg/pkg/node.py": b"n", "pkg/.gitignore": b"g"}


@pytest.mark.parametrize("where", ["ros2_ws/src/", "notebooks/ros2_ws/src/", "ros2_ws.zip"])
def test_the_workspace_beside_a_notebook(tmp_path: Path, where: str):
    built = {"ros2_ws/build/x": "", "ros2_ws/install/y": "", "ros2_ws/log/z": ""}
    files: dict[str, bytes | str] = {f"alice/notebooks/{TOPICS}": "a", **{f"alice/{n}": c for n, c in built.items()}}
    if where.endswith("zip"):
        files["alice/ros2_ws.zip"] = zipped({f"src/{name}": content for name, content in SOURCES.items()})
    else:
        unwanted = ("pkg/__pycache__/x.pyc", ".git/config", "build/pkg/x", "install/setup.sh", "log/latest")
        files |= {f"alice/{where}{name}": content for name, content in SOURCES.items()}
        files |= {f"alice/{where}{name}": "" for name in unwanted}
    for (found,) in in_folder_and_zip(tmp_path, files):
        assert found == HandIn("alice", {TOPICS: b"a"}, SOURCES)


def test_the_workspace_beside_the_notebooks_that_count(tmp_path: Path):
    files = {f"alice/{week}/ros2_ws/src/p/package.xml": week for week in ("a", "b", "c")}
    lay(tmp_path, files | {f"alice/b/{TOPICS}": "", f"alice/a/{TOPICS}": "", "alice/b/02_workspace.ipynb": ""})
    (found,) = find(tmp_path, NAMES)
    assert found.workspace == {"p/package.xml": b"b"}
    assert "there are 3 workspaces; b/ros2_ws/src counts" in found.notes


def test_what_a_workspace_leaves_out_is_told(tmp_path: Path):
    src = lay(tmp_path / "alice/ros2_ws/src", {**SOURCES, "pkg/big.bin": bytes(1_000_001), "pkg/log/__init__.py": ""})
    lay(tmp_path / "alice", {TOPICS: "a"})
    (src / "passwd").symlink_to("/etc/passwd")
    (src / "linked").symlink_to("/etc")
    os.mkfifo(src / "fifo")
    (src / "a\\b").write_text("")
    (src / "a\nb").write_text("")
    (found,) = find(tmp_path, NAMES)
    assert found.workspace == SOURCES
    assert set(found.notes) == {
        "ros2_ws/src/linked, ros2_ws/src/passwd were left out: links are not followed",
        "ros2_ws/src/fifo was left out: it is no regular file",
        "ros2_ws/src/a\ufffdb, ros2_ws/src/a\\b were left out: its name cannot be the one of a source",
        "ros2_ws/src/pkg/log was left out: a folder of this name is taken for what colcon built",
        "ros2_ws/src/pkg/big.bin was left out: it has 1.0 MB, and at most 1.0 MB are read",
    }


def test_a_workspace_is_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(handin_workspace, "MAX_FILES", 3)
    monkeypatch.setattr(handin_workspace, "MAX_TOTAL", 2)
    lay(tmp_path, {f"alice/ros2_ws/src/{name}": "x" for name in "abc"})
    (found,) = find(tmp_path, NAMES)
    assert found.workspace == {"a": b"x", "b": b"x"}
    assert found.notes[-1] == "ros2_ws/src/c was left out: all files of ros2_ws/src have more than 2 bytes"
    monkeypatch.setattr(handin_workspace, "MAX_FILES", 1)
    (found,) = find(tmp_path, NAMES)
    assert found.workspace == {"a": b"x"}
    assert "ros2_ws/src holds more than 1 files; from b on they were left out" in found.notes


def test_a_file_and_a_folder_of_one_name_cannot_both_be_sources(tmp_path: Path):
    files = {f"alice/{TOPICS}": "a", "alice/ros2_ws/src/p": "file", "alice/ros2_ws/src/p/q": "q"}
    (tmp_path / "hw.zip").write_bytes(zipped(files))
    (found,) = find(tmp_path / "hw.zip", NAMES)
    assert found.workspace == {"p/q": b"q"}
    assert found.notes == ("ros2_ws/src/p was left out: there is a folder of this name too",)
