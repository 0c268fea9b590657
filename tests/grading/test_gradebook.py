"""The files that grading writes, held against what spreadsheets, Moodle, Canvas and Gradescope take."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Any

import jsonschema  # type: ignore[import-untyped]
import pytest

from course_kit.classroom.report import gradebook
from course_kit.classroom.results import ExerciseResult, StudentResult
from course_kit.exercises.protocol.verdict import NOT_BEGUN, NOT_LOOKED_AT, Finding, Verdict

TITLE = "ROS 2, winter (4711)"
PROTECTION = "Each student's code ran in a sandbox of its own: no network, no files but its own."
# What is documented of results.json, as far as it is used here; a word of our own in it would be a mistake.
GRADESCOPE: dict[str, Any] = {
    "type": "object",
    "properties": {
        "score": {"type": "number"},
        "execution_time": {"type": "number"},
        "output": {"type": "string"},
        "output_format": {"enum": ["text", "html", "simple_format", "md", "ansi"]},
        "test_output_format": {"enum": ["text", "html", "simple_format", "md", "ansi"]},
        "test_name_format": {"enum": ["text", "html", "simple_format", "md", "ansi"]},
        "visibility": {"enum": ["hidden", "after_due_date", "after_published", "visible"]},
        "stdout_visibility": {"enum": ["hidden", "after_due_date", "after_published", "visible"]},
        "extra_data": {"type": "object"},
        "leaderboard": {"type": "array"},
        "tests": {
            "type": "array",
            "items": {
                "type": "object",
                "properties": {
                    "score": {"type": "number"},
                    "max_score": {"type": "number"},
                    "status": {"enum": ["passed", "failed"]},
                    "name": {"type": "string"},
                    "name_format": {"enum": ["text", "html", "simple_format", "md", "ansi"]},
                    "number": {"type": "string"},
                    "output": {"type": "string"},
                    "output_format": {"enum": ["text", "html", "simple_format", "md", "ansi"]},
                    "tags": {"type": "array", "items": {"type": "string"}},
                    "visibility": {"enum": ["hidden", "after_due_date", "after_published", "visible"]},
                    "extra_data": {"type": "object"},
                },
                "required": ["score"],
                "additionalProperties": False,
            },
        },
    },
    "required": ["score"],
    "additionalProperties": False,
}


def count_down(heard: int = 0, shown: str = "", tries: int = 1) -> ExerciseResult:
    """topics-1 with full points, or as it is when a wrong number was heard."""
    hint = f"Expected 10, 9, … 0, heard {heard} first. Look at `self.timer.cancel()` in '/countdown_{heard}'."
    findings = (
        Finding("it counts 10, 9, … 0 from when somebody listens, and stops", not heard, hint, 1),
        Finding("it publishes five numbers a second", True, max_points=1),
    )
    verdict = Verdict("topics-1", "Count down", 2, findings=findings, seed=1000 + heard)
    return ExerciseResult(verdict, shown, 3.25, tries)


def eight(ok: bool) -> ExerciseResult:
    findings = (
        Finding("there is a node `eight`", True),
        Finding("the turtle drives an 8", ok, "It drove one circle: the sign of `angular.z` never changed.", 4),
    )
    return ExerciseResult(Verdict("topics-2", "An eight", 4, findings=findings, seed=7), "", 12.0)


def star(state: str = "", note: str = "") -> ExerciseResult:
    if state:
        return ExerciseResult(Verdict("services-1", "A star", 3, state, note=note))
    finding = Finding("the star has five points", True, max_points=3)
    return ExerciseResult(Verdict("services-1", "A star", 3, findings=(finding,)), "5 points <done>", 1.5)


def student(name: str, *exercises: ExerciseResult, **more: Any) -> StudentResult:
    chosen = exercises or (count_down(), eight(True), star())
    return StudentResult(name, chosen, protection=PROTECTION, **more)


EVIL = "<script>alert('name')</script>"
COLOURED = "\x1b[31mTraceback\x1b[0m <script>alert('shown')</script>\n\x07\x1b]0;title\x07 10 %\r100 %\u202e\x00 & done"
NOT_YET = star(NOT_BEGUN, "Write your answer in the cell above `check()`.")
FAILED = star(NOT_LOOKED_AT, "The checker ended: `MemoryError`. Grade services-1 again.")


def a_class() -> list[StudentResult]:
    """What a class hands in: good, bad, late, nothing, odd names."""
    untouched = ExerciseResult(Verdict("topics-1", "Count down", 2, NOT_BEGUN, note="There is no answer."))
    untouched_2 = ExerciseResult(Verdict("topics-2", "An eight", 4, NOT_BEGUN, note="There is no answer."))
    anna = {"moodle": "1234567", "name": "Anna Ångström", "email": "anna@example.org"}
    script = student(EVIL, count_down(5, COLOURED, tries=2), eight(False), star(), notes=(f"left out: {EVIL}",))
    return [
        student("Anna Ångström_1234567_assignsubmission_file", ids=anna),
        student("=cmd|'/c calc'!A1", count_down(3), eight(False), NOT_YET, late=True, ids={"canvas": "42"}),
        student("bo", count_down(4), eight(True), FAILED, notes=("=1+1\nover\r\ntwo lines", "\tan earlier hand-in")),
        script,
        student("zoë", untouched, untouched_2, NOT_YET, ids={"canvas": "43", "name": "@zoë"}),
    ]


def rows_of(path: Path, encoding: str = "utf-8") -> list[list[str]]:
    return list(csv.reader(io.StringIO(path.read_bytes().decode(encoding), newline="")))


def test_a_row_a_student_a_column_an_exercise(tmp_path):
    gradebook.write(a_class(), tmp_path, TITLE)
    assert (tmp_path / "grades.csv").read_bytes().startswith("\ufeff".encode())
    head, anna, cmd, bo, *others = rows_of(tmp_path / "grades.csv", "utf-8-sig")
    points = ["topics-1", "topics-2", "services-1"]
    assert head == ["student", *points, "total", "maximum", "percent", "late", "notes"]
    assert anna[1:] == ["2", "4", "3", "9", "9", "100.0", "", ""]
    assert cmd == ["'=cmd|'/c calc'!A1", "1", "0", "0", "1", "9", "11.1", "late", ""]
    assert bo[1:5] == ["1", "4", "", "5"], "what could not be looked at is no 0"
    assert bo[-1] == "'=1+1 over two lines; an earlier hand-in; services-1 could not be looked at"
    assert len(others) == 2 and others[-1][1:7] == ["0", "0", "0", "0", "9", "0.0"]
    assert (tmp_path / "grades.csv").read_bytes().count(b"\r\n") == 6


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("=1+1", "'=1+1"),
        ("+1", "'+1"),
        ("-1", "'-1"),
        ("@SUM(A1)", "'@SUM(A1)"),
        ("\t=1+1", "'=1+1"),
        ("\r=1+1", "'=1+1"),
        ("\x00\x1b[1m =1", "'=1"),
        ("\uff1d1", "'\uff1d1"),
        ("a\r\nb\tc\x0bd", "a b cd"),
        ("O'Neill-Smith = 1", "O'Neill-Smith = 1"),
    ],
)
def test_no_text_of_others_is_a_formula(text, expected):
    assert gradebook.cell(text) == expected


def test_json_holds_everything_and_is_stable(tmp_path):
    results = [*a_class(), student("undecodable \udcff")]
    gradebook.write(results, tmp_path, TITLE)
    first = (tmp_path / "grades.json").read_bytes()
    data = json.loads(first)
    assert (data["format"], data["title"], data["protection"]) == (gradebook.FORMAT, TITLE, PROTECTION)
    assert [StudentResult.from_json(each) for each in data["students"]] == results
    gradebook.write(results, tmp_path, TITLE)
    assert (tmp_path / "grades.json").read_bytes() == first


def test_moodle_finds_its_columns_and_students(tmp_path):
    gradebook.write(a_class(), tmp_path, TITLE)
    head, *rows = rows_of(tmp_path / "moodle.csv")
    assert {"Identifier", "Grade", "Last modified (grade)", "Feedback comments"} <= set(head), "what its importer names"
    assert [row[:6] for row in rows] == [
        ["Participant 1234567", "Anna Ångström", "anna@example.org", "9", "9", "-"]
    ]  # nobody else has a number
    assert "<b>topics-1 · Count down: 2 of 2 points</b>" in rows[0][6]


def test_moodle_gets_no_html_of_students(tmp_path):
    finding = Finding(f"it says {EVIL}", False, EVIL, 1)
    result = student("a", ExerciseResult(Verdict("topics-1", "T", 1, findings=(finding,))), ids={"moodle": "1"})
    gradebook.write([result], tmp_path, TITLE)
    assert "<script" not in (tmp_path / "moodle.csv").read_text()


def test_canvas_finds_its_columns_and_students(tmp_path):
    gradebook.write(a_class(), tmp_path, TITLE)
    head, possible, *rows = rows_of(tmp_path / "canvas.csv")
    assert head == ["Student", "ID", "SIS User ID", "SIS Login ID", "Section", TITLE]
    assert possible[0].strip() == "Points Possible" and possible[1:] == ["", "", "", "", "9"]
    assert [(row[0], row[1], row[5]) for row in rows] == [
        ("Anna Ångström", "", "9"),
        ("'=cmd|'/c calc'!A1", "42", "1"),
        ("bo", "", "5"),
        (EVIL, "", "4"),
        ("'@zoë", "43", "0"),
    ]
    assert all(len(row) == 6 for row in rows)


def test_gradescope_gets_its_documented_form(tmp_path):
    results = a_class()
    files = gradebook.write(results, tmp_path, TITLE)
    found = [file for file in files if file.name == "results.json"]
    assert len(found) == len(results)
    for file, result in zip(found, results, strict=True):
        data = json.loads(file.read_text())
        jsonschema.validate(data, GRADESCOPE)
        assert data["score"] == sum(test["score"] for test in data["tests"]) == result.points
        assert {test["output_format"] for test in data["tests"]} == {"text"}
        assert "\x1b" not in json.dumps(data) and "\\u001b" not in json.dumps(data)
    bad, _, star = json.loads(found[3].read_text())["tests"]
    assert (bad["name"], bad["max_score"], bad["status"]) == ("topics-1 · Count down", 2, "failed")
    assert bad["output"].startswith("✘ it counts") and "heard 5 first" in bad["output"]
    assert bad["output"].endswith("Your cell printed:\nTraceback <script>alert('shown')</script>\n100 % & done")
    assert star["status"] == "passed"


def test_one_student_has_one_results_json(tmp_path):
    files = gradebook.write([student("only", late=True)], tmp_path, TITLE)
    assert tmp_path / "results.json" in files and not (tmp_path / "gradescope").exists()
    assert json.loads((tmp_path / "results.json").read_text())["output"] == "This was handed in late."


def test_nobody_has_handed_in(tmp_path):
    for file in gradebook.write([], tmp_path / "new", TITLE):
        assert file.exists()


def test_names_of_files_are_safe_and_told_apart():
    labels = [
        *("..", "/", "", "a/../b", "CON", "class", "lpt1", "-rf", ".hidden", "a\x00b\n", "\u202e"),
        *("Anna Smith", "anna smith", "ANNA-SMITH", "anna-smith-2"),
        *("李" * 60, "x" * 300, "X" * 300, "e\u0301", "\xe9", "straße", "STRASSE", "undecodable \udcff"),
    ]
    names = gradebook.file_names([student(label) for label in labels])
    assert list(names) == sorted(labels)
    folded = [name.casefold() for name in names.values()]
    assert len(set(folded)) == len(folded) and not gradebook.RESERVED & set(folded)
    for name in names.values():
        assert name and len(name.encode()) <= 80 and all(c.isalnum() or c in "-_" for c in name), name
        assert not name.startswith("-")
    assert [names[label] for label in ("ANNA-SMITH", "Anna Smith", "a/../b", "straße", "class")] == [
        *("ANNA-SMITH", "Anna-Smith-2", "a-b", "straße-2", "class-2"),
    ]


def test_names_of_files_do_not_depend_on_the_order():
    results = [student(label) for label in ("a", "A", "a!", "b")]
    assert gradebook.file_names(results) == gradebook.file_names(results[::-1])


def test_two_results_of_one_student_are_refused():
    with pytest.raises(ValueError, match="two results of 'anna'"):
        gradebook.file_names([student("anna"), student("anna")])
