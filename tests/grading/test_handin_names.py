"""Names of files and students: copies, dates, what a learning system adds, what cannot be printed."""

from __future__ import annotations

import os
import zipfile
from pathlib import Path

import pytest

from course_kit.classroom.collect.handin_names import notebook_of, number_of, printable, seconds_of, sender_of
from course_kit.classroom.collect.handins import HandIn, find
from tests.grading.made_handins import MOODLE, NAMES, TOPICS, in_folder_and_zip, lay, topics


@pytest.mark.parametrize(
    "name",
    [
        "03_topics.ipynb", "03_topics-1.ipynb", "03_topics (2).ipynb", "03_topics(2).ipynb", "03_topics_copy.ipynb",
        "03_topics - Copy.ipynb", "03_topics - Copy (3).ipynb", "03_topics-Copy1.ipynb", "03_topics-Copy1-2.ipynb",
        "03_topics copy 2.ipynb", "03_topics 2.ipynb", "03_topics - Kopie.ipynb", "Copy of 03_topics.ipynb",
        "03_Topics.IPYNB", "doe_12_34_03_topics-1.ipynb", f"Jo_1{MOODLE}03_topics (1).ipynb",
    ],
)  # fmt: skip
def test_copies_are_known_by_their_names(name: str):
    assert notebook_of(name, NAMES) == TOPICS


@pytest.mark.parametrize(
    "name",
    ["topics.ipynb", "03_topics.py", "03_topics_solution.ipynb", "xx03_topics.ipynb", "03_topics.ipynb.txt", ".ipynb"],
)
def test_others_are_none_of_the_course(name: str):
    assert notebook_of(name, NAMES) is None


def test_the_number_is_the_one_that_canvas_added():
    names = ("a_1_2_03_topics.ipynb", "a_1_2_03_topics-4.ipynb", "a_1_2_03_topics-Copy1-2.ipynb", "03_topics (9).ipynb")
    assert [number_of(name) for name in names] == [0, 4, 2, 0]


def test_no_notebook_is_taken_for_a_learning_system():
    assert [sender_of(name) for name in NAMES] == [None] * 4
    assert sender_of("hw_2024_03_topics.ipynb") is None


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        ("2026-03-01 10:00:00.5 UTC\n", 1772359200.0),
        ("2026-03-01 11:00:00 +0100", 1772359200.0),
        ("2026-03-01 05:00:00.123 America/New_York", 1772359200.0),
        ("2026-03-01 10:00:00 PDT/../../../etc/passwd", 1772359200.0),
        ("2026-03-01 10:00:00 America", 1772359200.0),
        ("2026-13-01 10:00:00 UTC", None),
        ("2026-03-01 10:00:00 +9999", 1772359200.0),
        ("soon", None),
    ],
)
def test_timestamps_of_nbgrader(text: str, seconds: float | None):
    assert seconds_of(text) == seconds


def test_the_last_counts_by_time_then_by_name(tmp_path: Path):
    lay(tmp_path, {f"alice/{folder}/{TOPICS}": folder for folder in "abc"} | {f"bob/x/{TOPICS}": ""})
    assert topics(find(tmp_path, NAMES))["alice"] == "c"
    os.utime(tmp_path / "alice/a" / TOPICS, (1_000_000_001, 1_000_000_001))
    assert topics(find(tmp_path, NAMES))["alice"] == "a"


def test_the_last_in_a_zip_counts(tmp_path: Path):
    with zipfile.ZipFile(tmp_path / "alice.zip", "w") as archive:
        for name, year in (("a", 2025), ("b", 2026), ("c", 2024)):
            archive.writestr(zipfile.ZipInfo(f"{name}/{TOPICS}", (year, 1, 1, 0, 0, 0)), name)
        archive.writestr(zipfile.ZipInfo(f"d/{TOPICS}", (1980, 0, 0, 0, 0, 0)), "no date")
    (found,) = find(tmp_path, NAMES)
    assert found.notebooks == {TOPICS: b"b"}
    assert found.notes == ("03_topics.ipynb was handed in 4 times; the last counts (alice.zip/b/03_topics.ipynb)",)


def test_what_programs_left_behind_is_no_hand_in(tmp_path: Path):
    files = {f"alice/{TOPICS}": "a", "bob/x.txt": ""}
    for noise in (".ipynb_checkpoints", "__MACOSX", ".hidden", "env"):
        files[f"alice/{noise}/{TOPICS}"] = noise
    files |= {"alice/._03_topics.ipynb": "", "alice/.DS_Store": "", "alice/env/pyvenv.cfg": "", "__MACOSX/b/x": ""}
    for found in in_folder_and_zip(tmp_path, files):
        assert [each.student for each in found] == ["alice", "bob"]
        assert found[0] == HandIn("alice", {TOPICS: b"a"})


WILD = [b"\xff\xfe", b"a\nb\x1b[31m", b"=cmd|' C calc'!A0", "ü‮x".encode(), b"y" * 250, b"-rf", b"..."]


@pytest.mark.parametrize("raw", WILD)
def test_wild_names_are_printable(tmp_path: Path, raw: bytes):
    name = os.fsdecode(raw)
    lay(tmp_path, {f"{name}/{name[:200]}.ipynb": "", f"{name}/{TOPICS}": "w", f"bob/{TOPICS}": "b"})
    found = {each.student: each for each in find(tmp_path, NAMES)}
    label = printable(name)
    assert found[label].notebooks == {TOPICS: b"w"}
    assert all(text.isprintable() and text.encode() for text in (label, *found[label].notes))
    assert "is none of the course's notebooks" in found[label].notes[0]


def test_wild_names_that_look_alike_stay_two(tmp_path: Path):
    for raw in (b"\xff", b"\xfe"):
        lay(tmp_path, {f"{os.fsdecode(raw)}/{TOPICS}": raw})
    found = find(tmp_path, NAMES)
    assert [(each.student, each.notebooks[TOPICS]) for each in found] == [("\ufffd", b"\xfe"), ("\ufffd (2)", b"\xff")]
