"""What learning systems export, found: who handed in what, which of it counts, what is left out and why."""

from __future__ import annotations

import errno
import io
import os
import random
import socket
import stat
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from course_kit.grading import handin_search, handin_workspace, handin_zips
from course_kit.grading.handin_files import File, Unread, on_disk
from course_kit.grading.handin_names import master_of, number_of, printable, seconds_of, sender_of
from course_kit.grading.handin_notes import Notes
from course_kit.grading.handins import HandIn, find, find_own

NAMES = ("01_setup_checks.ipynb", "02_workspace.ipynb", "03_topics.ipynb", "10_more.ipynb")
TOPICS = "03_topics.ipynb"
MOODLE = "_assignsubmission_file_"


def lay(folder: Path, files: Mapping[str, bytes | str]) -> Path:
    """Put files into a folder, all of one age."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        os.utime(path, (1_000_000_000, 1_000_000_000))
    return folder


def zipped(files: Mapping[str, bytes | str], method: int = zipfile.ZIP_DEFLATED) -> bytes:
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", method) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name), content, compress_type=method)
    return data.getvalue()


def topics(hand_ins: list[HandIn]) -> dict[str, str]:
    """Who handed in which 03_topics.ipynb."""
    return {each.student: each.notebooks[TOPICS].decode() for each in hand_ins if TOPICS in each.notebooks}


def in_folder_and_zip(tmp_path: Path, files: Mapping[str, bytes | str]) -> list[list[HandIn]]:
    """What is found in a folder of these files and in a zip of them."""
    (tmp_path / "hw.zip").write_bytes(zipped(files))
    return [find(lay(tmp_path / "hw", files), NAMES), find(tmp_path / "hw.zip", NAMES)]


# Layouts


def test_a_folder_for_each_student(tmp_path: Path):
    files = {
        "bob/notebooks/03_topics.ipynb": "b3",
        "alice/03_topics.ipynb": "a3",
        "alice/deep/er/01_setup_checks.ipynb": "a1",
        "marks.csv": "no student",
    }
    for found in in_folder_and_zip(tmp_path, files):
        assert [each.student for each in found] == ["alice", "bob"]
        assert list(found[0].notebooks.items()) == [("01_setup_checks.ipynb", b"a1"), (TOPICS, b"a3")]
        assert found[1] == HandIn("bob", {TOPICS: b"b3"})


@pytest.mark.parametrize("path", ["_file_/", "_file/", "_file_", "_file_/sub/folder/"])
def test_moodle(tmp_path: Path, path: str):
    files = {
        f"Änne O'Neill-Öz_1234567_assignsubmission{path}03_topics.ipynb": "ä",
        f"Bo Li_77_assignsubmission{path}03_topics.ipynb": "b",
        "Bo Li_77_assignsubmission_onlinetext_/onlinetext.html": "<p>",
        "Cy_78_assignsubmission_onlinetext_onlinetext.html": "<p>",
    }
    for found in in_folder_and_zip(tmp_path, files):
        assert topics(found) == {"Bo Li": "b", "Änne O'Neill-Öz": "ä"}
        assert found[1].ids == {"moodle": "1234567", "name": "Änne O'Neill-Öz"}
        assert [each.notes for each in found] == [(), ()]


def test_two_participants_of_one_name_stay_two(tmp_path: Path):
    files = {f"Jo Doe_{number}{MOODLE}/{TOPICS}": str(number) for number in (12, 7)}
    files |= {f"Jo Doe 7/{TOPICS}": "folder", f"Jo Doe/{TOPICS}": "another folder"}
    (found, in_zip) = in_folder_and_zip(tmp_path, files)
    expected = {"Jo Doe": "another folder", "Jo Doe 12": "12", "Jo Doe 7": "folder", "Jo Doe 7 (2)": "7"}
    assert topics(found) == topics(in_zip) == expected
    assert [each.ids.get("moodle") for each in found] == [None, "12", None, "7"]


def test_a_group_without_a_number(tmp_path: Path):
    (found,) = find(lay(tmp_path, {f"Default group{MOODLE}/{TOPICS}": "g"}), NAMES)
    assert (found.student, found.ids) == ("Default group", {"name": "Default group"})


def test_canvas(tmp_path: Path):
    files = {
        "doejane_12345_678901_03_topics.ipynb": "first",
        "doejane_12345_678902_03_topics-1.ipynb": "second",
        "doejane_12345_678903_03_topics-2.ipynb": "third",
        "doejane_12345_678904_01_setup_checks.ipynb": "j1",
        "poebob_LATE_22_678800_03_topics.ipynb": "late",
        "roe_33_678700_essay.pdf": "%PDF",
    }
    for found in in_folder_and_zip(tmp_path, files):
        assert topics(found) == {"doejane": "third", "poebob": "late"}
        doe, poe, roe = found
        assert (doe.ids, doe.late, doe.notebooks["01_setup_checks.ipynb"]) == ({"canvas": "12345"}, False, b"j1")
        counts = "03_topics.ipynb was handed in 3 times; the last counts (doejane_12345_678903_03_topics-2.ipynb)"
        assert doe.notes == (counts,)
        assert (poe.ids, poe.late) == ({"canvas": "22"}, True)
        assert (roe.student, dict(roe.notebooks)) == ("roe", {})
        assert roe.notes == ("none of the course's notebooks is here, but roe_33_678700_essay.pdf",)


def test_canvas_users_of_one_name_stay_two(tmp_path: Path):
    found = find(lay(tmp_path, {"doe_11_5_03_topics.ipynb": "a", "doe_12_6_03_topics.ipynb": "b"}), NAMES)
    assert topics(found) == {"doe 11": "a", "doe 12": "b"}


def test_canvas_counts_its_numbers_then_a_uuid_then_its_files(tmp_path: Path):
    files = {f"doe_11_{900 + n}_03_topics-{n}.ipynb": str(n) for n in (2, 7)}
    files["doe_11_950_03_topics-0b0dcd1a-7f0e-4d11-8e5d-0123456789ab.ipynb"] = "eighth"
    files["doe_11_951_03_topics-00000000-7f0e-4d11-8e5d-0123456789ab.ipynb"] = "ninth"
    assert topics(find(lay(tmp_path, files), NAMES)) == {"doe": "ninth"}


def test_canvas_without_names(tmp_path: Path):
    files = {"anon_AbC12_678901_03_topics.ipynb": "a", "LATE_anon_Xyz99_678902_10_more.ipynb": "x"}
    found = find(lay(tmp_path, files), NAMES)
    assert [(each.student, each.late, dict(each.ids)) for each in found] == [
        ("anon_AbC12", False, {}),
        ("anon_Xyz99", True, {}),
    ]


def test_names_that_look_like_canvas_by_accident_merge_nobody(tmp_path: Path):
    files = {f"ws_2024_25_{who}.zip": zipped({TOPICS: who}) for who in ("alice", "bob")}
    assert topics(find(lay(tmp_path, files), NAMES)) == {"ws_2024_25_alice": "alice", "ws_2024_25_bob": "bob"}


@pytest.mark.parametrize("where", ["", "submitted"])
def test_nbgrader(tmp_path: Path, where: str):
    lay(
        tmp_path,
        {
            "submitted/alice/ch3/03_topics.ipynb": "early",
            "submitted/alice/ch3/timestamp.txt": "2026-03-01 10:00:00.000001 UTC",
            "submitted/alice/again/03_topics.ipynb": "late",
            "submitted/alice/again/timestamp.txt": "2026-03-01 06:00:00 America/New_York",
            "submitted/bob/ch3/03_topics.ipynb": "b",
            "source/ch3/03_topics.ipynb": "the instructor's",
            "gradebook.db": "",
        },
    )
    os.utime(tmp_path / "submitted/alice/ch3/03_topics.ipynb")  # newer, but handed in earlier
    found = find(tmp_path / where, NAMES)
    assert topics(found) == {"alice": "late", "bob": "b"}
    assert found[0].notes == ("03_topics.ipynb was handed in 2 times; the last counts (again/03_topics.ipynb)",)


def test_all_layouts_mixed(tmp_path: Path):
    lay(
        tmp_path,
        {
            f"ann/{TOPICS}": "folder",
            f"Ben B_1{MOODLE}/{TOPICS}": "moodle",
            f"cy_9_99_{TOPICS}": "canvas",
            f"submitted/dee/ch3/{TOPICS}": "nbgrader",
            "eve.zip": zipped({f"work/{TOPICS}": "zip"}),
            f"fay_8_98_{TOPICS[:-6]}.zip": zipped({TOPICS: "canvas zip"}),
            f"Gus G_2{MOODLE}work.zip": zipped({TOPICS: "moodle zip"}),
            "HW3-1.zip": zipped({f"Hal H_3{MOODLE}/{TOPICS}": "export"}),
            "HW4-1.zip": zipped({f"ivy_7_97_{TOPICS}": "export", "joe_6_96_a.zip": zipped({TOPICS: "zip in zip"})}),
        },
    )
    assert topics(find(tmp_path, NAMES)) == {
        "Ben B": "moodle",
        "Gus G": "moodle zip",
        "Hal H": "export",
        "ann": "folder",
        "cy": "canvas",
        "dee": "nbgrader",
        "eve": "zip",
        "fay": "canvas zip",
        "ivy": "export",
        "joe": "zip in zip",
    }


@pytest.mark.parametrize("around", ["hw/", "submissions/", "x/submitted/", "submitted/"])
def test_a_folder_around_all(tmp_path: Path, around: str):
    files = {f"{around}{who}/{TOPICS}": who for who in ("alice", "bob")}
    for found in in_folder_and_zip(tmp_path, files):
        assert topics(found) == {"alice": "alice", "bob": "bob"}


def test_a_folder_and_a_zip_of_one_student(tmp_path: Path):
    (found,) = find(lay(tmp_path, {f"alice/{TOPICS}": "old", "alice.zip": zipped({TOPICS: "older"})}), NAMES)
    assert found.notebooks == {TOPICS: b"old"}  # the zip says 1980
    assert found.notes == ("03_topics.ipynb was handed in 2 times; the last counts (03_topics.ipynb)",)


# One student


def test_one_notebook(tmp_path: Path):
    lay(tmp_path / "alice", {TOPICS: "a", f"doe_LATE_1_2_{TOPICS}": "d"})
    assert find(tmp_path / "alice" / TOPICS, NAMES) == [HandIn("alice", {TOPICS: b"a"})]
    late = HandIn("doe", {TOPICS: b"d"}, ids={"canvas": "1"}, late=True)
    assert find_own(tmp_path / "alice" / f"doe_LATE_1_2_{TOPICS}", NAMES) == late


@pytest.mark.parametrize("files", [{f"notebooks/{TOPICS}": "a", "README.md": ""}, {TOPICS: "a", "images/x.png": ""}])
def test_a_clone_is_one_student(tmp_path: Path, files: dict[str, str], monkeypatch: pytest.MonkeyPatch):
    lay(tmp_path / "alice", files)
    (tmp_path / "alice.zip").write_bytes(zipped(files))
    expected = HandIn("alice", {TOPICS: b"a"})
    assert find_own(tmp_path / "alice", NAMES) == expected
    assert find(tmp_path / "alice", NAMES) == find(tmp_path / "alice.zip", NAMES) == [expected]
    assert find_own(tmp_path / "alice.zip", NAMES) == expected
    monkeypatch.chdir(tmp_path / "alice")
    assert find_own(Path("."), NAMES) == expected


def test_of_a_clone_of_the_course_only_its_notebooks_count(tmp_path: Path):
    files = {
        f"alice/{name}": name for name in (f"notebooks/{TOPICS}", "course_kit/x.py", f"tests/{TOPICS}", "README.md")
    }
    files |= {f"alice/build/failed-tests/x/{TOPICS}": "newer", "alice/notebooks/ros2_ws/src/p/a": "a"}
    lay(tmp_path, {**files, f"bob/{TOPICS}": "b"})
    os.utime(tmp_path / f"alice/build/failed-tests/x/{TOPICS}")
    expected = HandIn("alice", {TOPICS: f"notebooks/{TOPICS}".encode()}, {"p/a": b"a"})
    assert find(tmp_path, NAMES)[0] == find_own(tmp_path / "alice", NAMES) == expected
    (tmp_path / "alice.zip").write_bytes(zipped({f"clone-main/{k[6:]}": v for k, v in files.items()}))
    assert find_own(tmp_path / "alice.zip", NAMES) == expected


def test_a_folder_out_of_moodle_is_its_student(tmp_path: Path):
    lay(tmp_path / f"Jo Doe_12{MOODLE}", {TOPICS: "a"})
    (found,) = find(tmp_path / f"Jo Doe_12{MOODLE}", NAMES)
    assert (found.student, found.ids["moodle"]) == ("Jo Doe", "12")


def test_notebooks_beside_the_students_are_told(tmp_path: Path):
    nobodys, alice = find(lay(tmp_path / "HW", {f"alice/{TOPICS}": "a", TOPICS: "?", "me.ipynb": ""}), NAMES)
    assert alice == HandIn("alice", {TOPICS: b"a"})
    assert (nobodys.student, nobodys.notebooks) == ("HW", {TOPICS: b"?"})
    assert "me.ipynb is none of the course's notebooks" in nobodys.notes
    assert "these files lie beside those of the students, and their names tell nobody's" in nobodys.notes


def test_a_student_without_notebooks_is_told(tmp_path: Path):
    found = find(lay(tmp_path, {"alice/essay.txt": "", "bob/mine.ipynb": "{}", f"cy/{TOPICS}": "c"}), NAMES)
    assert [dict(each.notebooks) for each in found] == [{}, {}, {TOPICS: b"c"}]
    assert found[0].notes == ("none of the course's notebooks is here, but essay.txt",)
    assert found[1].notes == (
        "none of the course's notebooks is here",
        "mine.ipynb is none of the course's notebooks",
    )
    (tmp_path / "dee").mkdir()
    assert find(tmp_path, NAMES)[-1] == HandIn("dee", {}, notes=("none of the course's notebooks is here",))


def test_nothing_to_find(tmp_path: Path):
    with pytest.raises(FileNotFoundError, match=r"there is no .*/missing: expected a folder for each student"):
        find(tmp_path / "missing", NAMES)
    with pytest.raises(FileNotFoundError):
        find_own(tmp_path / "missing", NAMES)
    with pytest.raises(ValueError, match="nobody has handed in anything"):
        find(tmp_path, NAMES)
    with pytest.raises(ValueError, match="nobody has handed in anything"):
        find(lay(tmp_path, {"marks.csv": "", ".DS_Store": "", "__MACOSX/a/x.ipynb": ""}), NAMES)
    with pytest.raises(ValueError, match=r"marks.csv is no folder, no zip and no notebook"):
        find(tmp_path / "marks.csv", NAMES)
    for name, content in {"empty.zip": zipped({}), "damaged.zip": b"PK\3\4", "nothing.zip": b""}.items():
        (tmp_path / name).write_bytes(content)
        with pytest.raises(ValueError, match=r"nobody has handed in|no zip that can be read"):
            find(tmp_path / name, NAMES)
    os.mkfifo(tmp_path / "03_topics.ipynb")
    with pytest.raises(ValueError, match="no folder, no zip and no notebook"):
        find(tmp_path / "03_topics.ipynb", NAMES)
    (tmp_path / "round").symlink_to("round")
    with pytest.raises(ValueError, match="round"):
        find(tmp_path / "round", NAMES)
    with pytest.raises(ValueError):
        find(tmp_path / "nul\0", NAMES)


# Names


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
    assert master_of(name, NAMES) == TOPICS


@pytest.mark.parametrize(
    "name",
    ["topics.ipynb", "03_topics.py", "03_topics_solution.ipynb", "xx03_topics.ipynb", "03_topics.ipynb.txt", ".ipynb"],
)
def test_others_are_none_of_the_course(name: str):
    assert master_of(name, NAMES) is None


def test_the_number_is_the_one_that_canvas_added():
    names = ("a_1_2_03_topics.ipynb", "a_1_2_03_topics-4.ipynb", "a_1_2_03_topics-Copy1-2.ipynb", "03_topics (9).ipynb")
    assert [number_of(name) for name in names] == [0, 4, 2, 0]


def test_no_master_is_taken_for_a_learning_system():
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


# The workspace


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


# What must not be read


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


# Zips


@pytest.mark.parametrize(
    ("name", "why"),
    [
        (f"../../{TOPICS}", "leads out of it"),
        (f"a/../{TOPICS}", "leads out of it"),
        (f"/etc/{TOPICS}", "an absolute one"),
        (f"C:{TOPICS}", "an absolute one"),
        (f"C:\\x\\{TOPICS}", "an absolute one"),
        (f"..\\{TOPICS}", "leads out of it"),
        (f"sub\\{TOPICS}", "has backslashes"),
        (f"{'d/' * 40}{TOPICS}", "too deep"),
        (f"{'n' * 300}/{TOPICS}", "none of a file"),
    ],
)
def test_unsafe_names_in_a_zip(tmp_path: Path, name: str, why: str):
    content = {name: "bad", "01_setup_checks.ipynb": "good"}
    (found,) = find(lay(tmp_path / "one", {"alice.zip": zipped(content)}), NAMES)
    assert (found.student, found.notebooks) == ("alice", {"01_setup_checks.ipynb": b"good"})
    assert len(found.notes) == 1 and why in found.notes[0] and found.notes[0].isprintable()
    (tmp_path / "hw.zip").write_bytes(zipped({f"alice/{TOPICS}": "a", f"bob/{TOPICS}": "b", name: "bad"}))
    assert topics(find(tmp_path / "hw.zip", NAMES)) == {"alice": "a", "bob": "b"}  # and nobody new of this name
    assert any(why in note for each in find(tmp_path / "hw.zip", NAMES) for note in each.notes)
    assert sorted(os.listdir(tmp_path)) == ["hw.zip", "one"]


def test_an_unsafe_name_below_a_students_folder_is_told_of_her(tmp_path: Path):
    (tmp_path / "hw.zip").write_bytes(zipped({f"alice/../bob/{TOPICS}": "x", f"bob/{TOPICS}": "b"}))
    alice, bob = find(tmp_path / "hw.zip", NAMES)
    assert "alice/../bob/03_topics.ipynb was left out: its name in the zip leads out of it" in alice.notes[1]
    assert bob == HandIn("bob", {TOPICS: b"b"})


def only_notes(tmp_path: Path, data: bytes) -> str:
    """What is told of a student whose zip this is, and of which nothing counts."""
    (found,) = find(lay(tmp_path, {"alice/work.zip": data}), NAMES)
    assert (found.student, dict(found.notebooks)) == ("alice", {})
    return " | ".join(found.notes)


def patched(data: bytes, **fields: int) -> bytes:
    """A zip of one member with other values in both of its headers."""
    new = bytearray(data)
    for signature, places in ((b"PK\3\4", {"flags": 6, "size": 22}), (b"PK\1\2", {"flags": 8, "size": 24})):
        at = data.index(signature)
        for name, value in fields.items():
            length = 2 if name == "flags" else 4
            new[at + places[name] : at + places[name] + length] = value.to_bytes(length, "little")
    return bytes(new)


def test_zips_that_cannot_be_read(tmp_path: Path):
    fine = zipped({TOPICS: b"0123456789" * 50}, zipfile.ZIP_STORED)
    assert "no zip that can be read" in only_notes(tmp_path, b"")
    assert "no zip that can be read" in only_notes(tmp_path, fine[:-30])
    assert "03_topics.ipynb was left out: it is encrypted" in only_notes(tmp_path, patched(fine, flags=1))
    assert "it cannot be read (Bad CRC-32" in only_notes(tmp_path, fine.replace(b"0123", b"3210", 1))
    bzip2 = zipped({TOPICS: bytes(10_000)}, zipfile.ZIP_BZIP2)
    assert "its way of packing is not read (bzip2)" in only_notes(tmp_path, bzip2)
    link = zipfile.ZipInfo(TOPICS)
    link.external_attr = (stat.S_IFLNK | 0o777) << 16
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as archive:
        archive.writestr(link, "/etc/passwd")
    assert "links are not followed" in only_notes(tmp_path, data.getvalue())
    assert "of archives only zips are read" in " ".join(find(lay(tmp_path, {"alice/a.rar": ""}), NAMES)[0].notes)


def test_bombs(tmp_path: Path):
    declared = zipped({TOPICS: bytes(19_000_000)})
    assert "packed like a zip bomb (19.0 MB in 18,4" in only_notes(tmp_path, declared)
    too_big = zipped({TOPICS: random.Random(1).randbytes(20_000_001)}, zipfile.ZIP_STORED)
    assert "03_topics.ipynb was left out: it has 20.0 MB" in only_notes(tmp_path, too_big)
    real = patched(declared, size=1000)  # it says that it is small: no more is read
    assert "03_topics.ipynb was left out: it cannot be read" in only_notes(tmp_path, real)
    claimed = patched(zipped({TOPICS: b"x"}), size=0xFFFFFFF0)
    assert "packed like a zip bomb" in only_notes(tmp_path, claimed)


def test_limits_of_zips(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(handin_zips, "MAX_MEMBERS", 3)
    assert "holds more than 3 files" in only_notes(tmp_path, zipped({f"{n}.ipynb": "" for n in range(4)}))
    nested = zipped({"a.zip": zipped({TOPICS: "a" * 500}), "b.zip": zipped({TOPICS: "b" * 500})}, zipfile.ZIP_STORED)
    monkeypatch.setattr(handin_search, "MAX_ZIPS", 200)
    (found,) = find(lay(tmp_path, {"alice/work.zip": nested}), NAMES)
    assert found.notebooks == {TOPICS: b"a" * 500}
    assert found.notes == ("work.zip/b.zip was left out: the zips in zips have more than 200 bytes",)
    monkeypatch.setattr(handin_zips, "MAX_READ", 100)
    assert "table of contents is too long" in only_notes(tmp_path, zipped({f"{n * 80}": "" for n in range(3)}))


def test_zips_nest_once(tmp_path: Path):
    inner = zipped({TOPICS: "deep"})
    lay(tmp_path, {"alice.zip": zipped({"a.zip": inner}), "bob.zip": zipped({"b.zip": zipped({"c.zip": inner})})})
    alice, bob = find(tmp_path, NAMES)
    assert alice.notebooks == {TOPICS: b"deep"}
    assert "bob.zip/b.zip/c.zip was left out: zips are nested too deep" in bob.notes
    (tmp_path / "hw.zip").write_bytes(zipped({"alice.zip": inner, "bob.zip": zipped({"b.zip": inner})}))
    alice, bob = find(tmp_path / "hw.zip", NAMES)
    assert (alice.student, alice.notebooks) == ("alice", {TOPICS: b"deep"})
    assert "bob.zip/b.zip was left out: zips are nested too deep" in bob.notes


def test_a_damaged_zip_does_not_stop_the_class(tmp_path: Path):
    damaged = zipped({TOPICS: "x"})[:-9]
    files = {"alice.zip": damaged, "bob.zip": zipped({TOPICS: "b"}), f"cy_1_2_{TOPICS[:-6]}.zip": damaged}
    for found in in_folder_and_zip(tmp_path, files):
        assert [each.student for each in found] == ["alice", "bob", "cy"]
        assert topics(found) == {"bob": "b"}
        assert "alice.zip was left out: it is no zip that can be read" in found[0].notes[1]


def test_a_member_that_is_twice_in_a_zip(tmp_path: Path):
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as archive, pytest.warns(UserWarning, match="Duplicate"):
        archive.writestr(TOPICS, "first")
        archive.writestr(TOPICS, "second")
    (found,) = find(lay(tmp_path, {"alice.zip": data.getvalue()}), NAMES)
    assert found.notebooks == {TOPICS: b"second"}
    assert "more than once" in found.notes[0]


def test_files_are_closed(tmp_path: Path):
    lay(tmp_path, {f"{n}.zip": zipped({TOPICS: str(n)}) for n in range(100)})
    before = os.listdir("/proc/self/fd")
    assert len(find(tmp_path, NAMES)) == 100
    assert os.listdir("/proc/self/fd") == before


# Whatever comes


def test_the_order_of_folders_does_not_matter(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    files = {f"{who}/{week}/{TOPICS}": who + week for who in "cab" for week in "zxy"}
    files |= {f"{who}/{week}/ros2_ws/src/{name}": week for who in "ab" for week in "zx" for name in "qrp"}
    expected = find(lay(tmp_path, files | {"d.ipynb": "", "e_1_2_x.pdf": "", "f_2_1_y.pdf": ""}), NAMES)
    scandir = os.scandir

    class Shuffled:
        def __init__(self, path: str) -> None:
            with scandir(path) as found:
                self.entries = list(found)
            random.shuffle(self.entries)

        def __enter__(self) -> Any:
            return iter(self.entries)

        def __exit__(self, *_: object) -> None:
            pass

    monkeypatch.setattr(os, "scandir", Shuffled)
    for _ in range(10):
        found = find(tmp_path, NAMES)
        assert found == expected
        assert [list(each.workspace) for each in found] == [list(each.workspace) for each in expected]


FEW = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
PART = st.sampled_from(
    ["..", ".", "", "C:", "a", "b\\c", TOPICS, "ros2_ws", "src", "x.zip", "=1+1", "d\n", "Ü_1", "\x07"]
)
ZIP_NAME = st.one_of(
    st.lists(PART, min_size=1, max_size=6).map("/".join), st.text(min_size=1, max_size=20)
).filter(lambda name: not any("\ud800" <= c <= "\udfff" for c in name))  # fmt: skip


@FEW
@given(names=st.lists(ZIP_NAME, min_size=1, max_size=8, unique=True))
def test_any_names_in_zips_are_harmless(tmp_path: Path, names: list[str]):
    (tmp_path / "hw.zip").write_bytes(zipped({name: "x" for name in names}))
    try:
        found = find(tmp_path / "hw.zip", NAMES)
    except ValueError as error:
        assert "nobody has handed in" in str(error)
        return
    labels = [each.student for each in found]
    assert labels == sorted(set(labels)) and all(label.isprintable() and label for label in labels)
    assert all(note.isprintable() for each in found for note in each.notes)
    for path in (Path(path) for each in found for path in each.workspace):
        assert not path.is_absolute() and ".." not in path.parts
    assert os.listdir(tmp_path) == ["hw.zip"]


@FEW
@given(changes=st.lists(st.tuples(st.integers(0, 10_000), st.integers(0, 255)), min_size=1, max_size=12))
def test_any_damage_of_a_zip_is_survived(tmp_path: Path, changes: list[tuple[int, int]]):
    data = bytearray(zipped({f"alice/{TOPICS}": "a" * 100, "bob.zip": zipped({TOPICS: "b"})}))
    for place, value in changes:
        data[place % len(data)] = value
    lay(tmp_path, {f"cy/{TOPICS}": "c", "dee.zip": bytes(data)})
    found = find(tmp_path, NAMES)
    assert topics(found)["cy"] == "c" and len(found) >= 2
    (tmp_path / "dee.zip").replace(tmp_path / "cy/dee.zip")
    assert [each.student for each in find(tmp_path, NAMES)] == ["cy"]


@given(st.text(alphabet=st.characters(), max_size=400))
def test_anything_becomes_printable(text: str):
    shown = printable(text)
    assert shown and shown.isprintable() and len(shown) <= 100 and shown.encode()


@given(st.text(max_size=300), st.sampled_from(["", "_12_34_03_topics.ipynb", f"_5{MOODLE}"]))
def test_any_name_can_be_asked(text: str, end: str):
    sender_of(text + end)
    number_of(text + end)
    assert master_of(text + end, NAMES) in (None, *NAMES)
