"""The points of a class as files: for spreadsheets, for programs, for Moodle, Canvas and Gradescope. Pure: no ROS."""

from __future__ import annotations

import csv
import io
import json
import re
import unicodedata
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from course_kit.base.atomic_files import write_whole
from course_kit.classroom.plain_text import plain
from course_kit.classroom.results import ExerciseResult, StudentResult
from course_kit.exercises.protocol.verdict import LOOKED_AT, NOT_LOOKED_AT

FORMAT = 1  # of grades.json
LONGEST_NAME = 80  # bytes of UTF-8
# Windows keeps these for devices; class.html is the page of the class.
RESERVED = {"class", "con", "prn", "aux", "nul", *(f"{port}{n}" for port in ("com", "lpt") for n in range(10))}
# A spreadsheet takes a cell that begins so for a formula; the last four are = + - @ of Japanese keyboards.
FORMULA = tuple("=+-@\uff1d\uff0b\uff0d\uff20")


def write(results: Sequence[StudentResult], folder: Path, title: str) -> list[Path]:
    """Write the gradebook of a class into a folder; return its files."""
    files = {
        # Excel opens a CSV file as UTF-8 only if it begins with a byte order mark. Those that import the others do not.
        "grades.csv": _csv(_grades(results)).encode("utf-8-sig"),
        "grades.json": _json(_everything(results, title)),
        "moodle.csv": _csv(_moodle(results)).encode(),
        "canvas.csv": _csv(_canvas(results, title)).encode(),
    }
    if len(results) == 1:
        files["results.json"] = _json(_gradescope(results[0]))
    else:
        names = file_names(results)
        for result in results:
            files[f"gradescope/{names[result.student]}/results.json"] = _json(_gradescope(result))
    return [write_whole(folder / name, content) for name, content in files.items()]


def file_names(results: Iterable[StudentResult]) -> dict[str, str]:
    """A name for files about each student, by student: safe on every system, and told apart also where case is not."""
    names: dict[str, str] = {}
    taken = set(RESERVED)
    for student in sorted(result.student for result in results):  # whatever order they come in
        if student in names:
            raise ValueError(f"there are two results of {student!r}: one would hide the other")
        stem = name = (
            _cut(re.sub(r"[^\w-]+", "-", unicodedata.normalize("NFC", plain(student))).strip("-_")) or "student"
        )
        number = 2
        while name.casefold() in taken:
            name = f"{_cut(stem, 5)}-{number}"
            number += 1
        taken.add(name.casefold())
        names[student] = name
    return names


def _cut(name: str, spare: int = 0) -> str:
    """What of a name fits a file system, which counts bytes."""
    return name.encode()[: LONGEST_NAME - spare].decode(errors="ignore")


def cell(text: str) -> str:
    """Text of others for a spreadsheet: one line, and never a formula."""
    line = " ".join(plain(text).split())
    return f"'{line}" if line.startswith(FORMULA) else line


def name_of(result: StudentResult) -> str:
    """What a student is called: as the learning system tells it, else the label of the hand-in."""
    return result.ids.get("name") or result.student


def not_looked_at(result: StudentResult) -> list[str]:
    """The exercises that the checker failed on: their points are open."""
    return [each.verdict.exercise for each in result.exercises if each.verdict.state == NOT_LOOKED_AT]


def _grades(results: Sequence[StudentResult]) -> Iterable[Sequence[object]]:
    names = list(dict.fromkeys(each.verdict.exercise for result in results for each in result.exercises))
    yield ["student", *names, "total", "maximum", "percent", "late", "notes"]
    for result in results:
        open_ones = not_looked_at(result)
        points = {e.verdict.exercise: e.verdict.points for e in result.exercises if e.verdict.exercise not in open_ones}
        percent = round(100 * result.points / result.max_points, 1) if result.max_points else ""
        notes = [*result.notes, *(f"{name} could not be looked at" for name in open_ones)]
        late = "late" if result.late else ""
        total = [result.points, result.max_points, percent, late, cell("; ".join(notes))]
        # An empty cell is no 0: spreadsheets leave it out of means.
        yield [cell(result.student), *(points.get(name, "") for name in names), *total]


def _moodle(results: Sequence[StudentResult]) -> Iterable[Sequence[object]]:
    """For "Upload grading worksheet" of an assignment with the same maximum, whose columns it names.

    Moodle leaves out grades above its maximum, and those that it has newer ones of: here no time is told, so
    "Allow updating records" must be ticked from the second upload on. Feedback comments are HTML.
    """
    header = ["Identifier", "Full name", "Email address", "Grade", "Maximum grade", "Last modified (grade)"]
    yield [*header, "Feedback comments"]
    for result in results:
        if number := result.ids.get("moodle"):
            name, email = cell(name_of(result)), cell(result.ids.get("email", ""))
            notes = "".join(each.verdict._repr_html_() for each in result.exercises)
            yield [f"Participant {cell(number)}", name, email, result.points, result.max_points, "-", cell(notes)]


def _canvas(results: Sequence[StudentResult], title: str) -> Iterable[Sequence[object]]:
    """For "Import" of a course's gradebook. A title such as "ROS 2 (4711)" is the assignment 4711, which is there."""
    yield ["Student", "ID", "SIS User ID", "SIS Login ID", "Section", " ".join(title.split())]
    yield ["    Points Possible", "", "", "", "", max((result.max_points for result in results), default=0)]
    for result in results:
        yield [cell(name_of(result)), cell(result.ids.get("canvas", "")), "", "", "", result.points]


def _gradescope(result: StudentResult) -> dict[str, Any]:
    """What an autograder of Gradescope leaves in results.json."""
    late = ["This was handed in late."] if result.late else []
    return {
        "score": result.points,
        "execution_time": round(sum(each.seconds for each in result.exercises), 1),
        "output": plain("\n".join([*late, *result.notes])),
        "output_format": "text",
        "visibility": "visible",
        "tests": [_gradescope_test(each) for each in result.exercises],
    }


def _gradescope_test(each: ExerciseResult) -> dict[str, Any]:
    verdict = each.verdict
    said = str(verdict).splitlines()[0 if verdict.state != LOOKED_AT else 1 :]
    shown = ["", "Your cell printed:", each.shown] if each.shown else []
    return {
        "name": f"{verdict.exercise} · {verdict.title}",
        "score": verdict.points,
        "max_score": verdict.max_points,
        "status": "passed" if verdict.is_full else "failed",
        "output": plain("\n".join([*said, *shown])),
        "output_format": "text",  # as HTML, a student's text could run as a script
    }


def _everything(results: Sequence[StudentResult], title: str) -> dict[str, Any]:
    return {
        "format": FORMAT,
        "title": title,
        "protection": protection(results),
        "students": [result.to_json() for result in results],
    }


def protection(results: Sequence[StudentResult]) -> str:
    """What kept the students' code apart, in sentences."""
    return " ".join(dict.fromkeys(result.protection for result in results if result.protection))


def _csv(rows: Iterable[Sequence[object]]) -> str:
    text = io.StringIO()
    csv.writer(text).writerows(rows)
    return text.getvalue()


def _json(data: dict[str, Any]) -> bytes:
    return (json.dumps(data, indent=1, sort_keys=True) + "\n").encode()
