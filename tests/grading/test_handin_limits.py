"""What is not read of what was handed in: links, special files, what is too big or cannot be read."""

from __future__ import annotations

import errno
import os
import socket
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from course_kit.classroom.collect import handin_search
from course_kit.classroom.collect.handin_files import File, Unread, on_disk
from course_kit.classroom.collect.handin_notes import Notes
from course_kit.classroom.collect.handins import HandIn, find
from tests.grading.made_handins import NAMES, TOPICS, in_folder_and_zip, lay, topics


def test_links_and_special_files_are_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    lay(tmp_path / "secret", {TOPICS: "secret"})
    lay(tmp_path / "hw", {f"alice/02_workspace.ipynb/{TOPICS}": "x", "bob/x": ""})
    alice = tmp_path / "hw/alice"
    (alice / TOPICS).symlink_to(tmp_path / "secret" / TOPICS)
    (alice / "notebooks").symlink_to(tmp_path / "secret")
    (alice / "10_more.ipynb").symlink_to("/dev/zero")
    os.mkfifo(alice / "01_setup_checks.ipynb")
    os.mkfifo(alice / "work.zip")
    os.mkfifo(alice / "timestamp.txt")
    (tmp_path / "hw/carl").symlink_to(tmp_path / "secret")
    os.mkfifo(tmp_path / "hw/dora.zip")
    with socket.socket(socket.AF_UNIX) as listening:
        monkeypatch.chdir(alice)  # the path of a socket is short
        listening.bind("socket.ipynb")
    found = {each.student: each for each in find(tmp_path / "hw", NAMES)}
    assert sorted(found) == ["alice", "bob", "carl", "dora"]
    assert not any(each.notebooks for each in found.values())
    assert "03_topics.ipynb, 10_more.ipynb, notebooks were left out: links are not followed" in found["alice"].notes
    special = "01_setup_checks.ipynb, socket.ipynb, work.zip were left out: it is no regular file"
    assert special in found["alice"].notes
    assert "02_workspace.ipynb was left out: it is a folder" in found["alice"].notes
    assert "carl was left out: links are not followed" in found["carl"].notes
    assert "dora.zip was left out: it is no regular file" in found["dora"].notes


def test_a_file_that_became_a_link_meanwhile_is_not_read(tmp_path: Path):
    lay(tmp_path, {"file": "x", "other": "secret"})
    file = on_disk(tmp_path / "file")
    assert isinstance(file, File)
    (tmp_path / "file").unlink()
    (tmp_path / "file").symlink_to(tmp_path / "other")
    with pytest.raises(Unread, match="cannot be read"):
        file.read(100)
    (tmp_path / "file").unlink()
    os.mkfifo(tmp_path / "file")
    with pytest.raises(Unread, match="no regular file"):
        file.read(100)


def test_the_folder_itself_may_be_a_link(tmp_path: Path):
    lay(tmp_path / "hw", {f"alice/{TOPICS}": "a"})
    (tmp_path / "link").symlink_to("hw")
    assert topics(find(tmp_path / "link", NAMES)) == {"alice": "a"}


def test_unreadable_ones_are_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    lay(tmp_path, {f"alice/{TOPICS}": "a", f"bob/{TOPICS}": "b", f"cy/{TOPICS}": "c"})

    def refusing(function: Callable[..., Any], ending: str) -> Callable[..., Any]:
        def refused(path: Any, *rest: Any) -> Any:  # root, who may run this test, would be let in
            if os.fspath(path).endswith(ending):
                raise PermissionError(errno.EACCES, "Permission denied", path)
            return function(path, *rest)

        return refused

    monkeypatch.setattr(os, "open", refusing(os.open, f"alice/{TOPICS}"))
    monkeypatch.setattr(os, "scandir", refusing(os.scandir, "bob"))
    alice, bob, cy = find(tmp_path, NAMES)
    assert "03_topics.ipynb was left out: it cannot be read (Permission denied)" in alice.notes
    assert "the folder was left out: it cannot be read (Permission denied)" in bob.notes
    assert cy == HandIn("cy", {TOPICS: b"c"})
    monkeypatch.setattr(os, "scandir", refusing(os.scandir, tmp_path.name))
    with pytest.raises(ValueError, match=r": it cannot be read \(Permission denied\); expected"):
        find(tmp_path, NAMES)


def test_a_huge_notebook_is_left_out_and_the_one_before_counts(tmp_path: Path):
    lay(tmp_path, {f"alice/{TOPICS}": "", "alice/03_topics-1.ipynb": "fine"})
    with open(tmp_path / "alice" / TOPICS, "wb") as file:
        file.truncate(100_000_000)  # of holes; newer than the other one
    (found,) = find(tmp_path, NAMES)
    assert found.notebooks == {TOPICS: b"fine"}
    assert found.notes == (
        "03_topics.ipynb was handed in 2 times; the last counts (03_topics-1.ipynb)",
        "03_topics.ipynb was left out: it has 100.0 MB, and at most 20.0 MB are read",
    )


def test_a_student_with_too_many_files_does_not_stop_the_class(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(handin_search, "MAX_ENTRIES", 5)
    files = {f"alice/many/{n}": "" for n in range(9)} | {f"alice/few/{TOPICS}": "a", f"bob/{TOPICS}": "b"}
    for found in in_folder_and_zip(tmp_path, files):
        assert topics(found) == {"alice": "a", "bob": "b"}
        assert found[0].notes == ("many was left out: there are more than 5 files",)


def test_notes_are_bounded(tmp_path: Path):
    (found,) = find(lay(tmp_path, {f"alice/{n}.ipynb": "" for n in range(100)}), NAMES)
    assert found.notes[1] == "0.ipynb, 1.ipynb, 10.ipynb and 97 more are none of the course's notebooks"
    notes = Notes()
    for n in range(100):
        notes.add(f"line {n} {'x' * 1000}")
    assert (len(notes.lines()), notes.lines()[-1]) == (31, "and 70 notes more")
    assert max(map(len, notes.lines())) == 500
    notes = Notes()
    for n in range(9):
        notes.leave_out(str(n), "why")
    assert notes.lines() == ("0, 1, 2 and 6 more were left out: why",)
