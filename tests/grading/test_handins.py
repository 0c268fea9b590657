"""What was handed in is found, in each layout of a learning system."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from course_kit.classroom.collect.handins import HandIn, find, find_own
from course_kit.classroom.run import submission
from tests.grading.classes import ASKED, CHAPTER, FORMATS, NAME, exported, students
from tests.grading.handed_in import CHAPTERS
from tests.grading.made_handins import MOODLE, NAMES, TOPICS, in_folder_and_zip, lay, topics, zipped

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


def test_the_start_page_is_handed_in_with_the_chapters_and_nothing_is_said_of_it(tmp_path: Path):
    lay(tmp_path, {f"alice/notebooks/{name}": "a" for name in (TOPICS, "0_start.ipynb", "0_start (1).ipynb")})
    assert find(tmp_path, NAMES) == [HandIn("alice", {TOPICS: b"a"})]


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


# A class


def test_a_class_of_sixty_is_read_alike_in_each_format(tmp_path: Path):
    sixty, read = list(students(60)), {}
    for form in FORMATS:
        found = find(exported(tmp_path / form, form, sixty), [NAME])
        late = {student.name for student in sixty for one in found if one.late and student.name in one.student}
        assert late == ({student.name for student in sixty if student.is_late} if form == "canvas" else set())
        works = [submission.read(one, [CHAPTERS[CHAPTER]], ASKED).works for one in found]
        read[form] = [work.sources for (work,) in works]
    assert len(read["folders"]) == len(sixty)
    assert sum(map(bool, read["folders"])) > 0.9 * len(sixty)
    assert [form for form in FORMATS if read[form] != read["folders"]] == []
