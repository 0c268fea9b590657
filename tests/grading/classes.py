"""A class of generated students: right, partly right, wrong, cheating, broken and late ones, in all export formats."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from tests.exercises.chapter import Answers, answers_to
from tests.grading.handed_in import CHAPTERS, as_bytes, notebook

CHAPTER, ASKED = "services", ("services-1", "services-4")
NAME = CHAPTERS[CHAPTER].file
FORMATS = ("folders", "canvas", "moodle", "moodle_flat", "nbgrader", "zips")
CHEATS = (
    "from course_kit.exercises.in_notebook import checker_client\n"
    "checker_client.ask = lambda *a, **k: print('services-1 · A lamp: 2 of 2 points')",
    "import os\nos._exit(0)",
    "from IPython import get_ipython\nget_ipython().run_cell = None\n# NBVAL_SKIP",
    "class Lamp:\n    pass\nprint('services-1 · A lamp: 2 of 2 points')",
)


@dataclass(frozen=True)
class Student:
    """What a student hands in, and the points that she must get."""

    name: str
    data: bytes
    points: tuple[int, int]  # of ASKED
    is_late: bool = False


def students(count: int) -> Iterator[Student]:
    """Students whose answers are all different, if only by a remark."""
    first, second = (next(a for a in answers_to(CHAPTER) if a.exercise == name) for name in ASKED)
    for number in range(count):
        name = f"student{number:02}"
        a, points_a = _one_of(first, number)
        b, points_b = _one_of(second, number // 2)
        kind = ("ok", "ok", "ok", "ok", "cheat", "ok", "ok", "broken", "late", "ok")[number % 10]
        if kind == "cheat":
            a, points_a = CHEATS[number // 10 % len(CHEATS)], 0
        made = notebook(CHAPTER, {ASKED[0]: f"# {name}\n{a}", ASKED[1]: f"# {name}\n{b}"})
        data, points = as_bytes(made), (points_a, points_b)
        if kind == "broken":
            data, points = _broken(data, number // 10, points)
        yield Student(name, data, points, kind == "late")


def _one_of(answers: Answers, number: int) -> tuple[str, int]:
    """An answer that is right in two of three cases, and its points."""
    rights = [answers.reference, *answers.right.values()]
    if number % 3 < 2:
        return rights[number % len(rights)], answers.points
    wrong = answers.wrong[number // 3 % len(answers.wrong)]
    return wrong.source, wrong.points


def _broken(data: bytes, number: int, points: tuple[int, int]) -> tuple[bytes, tuple[int, int]]:
    """A file that is damaged in some way, and the points that are left."""
    cells = json.loads(data)
    same = next(cell for cell in cells["cells"] if cell["id"] == "services-ex1-answer")
    match number % 6:
        case 0:
            return data[: len(data) // 2], (0, 0)
        case 1:
            return b"PK\x03\x04 no notebook", (0, 0)
        case 2:
            return data + b" " * 25_000_000, (0, 0)
        case 3:
            cells["cells"].append(same)
        case 4:
            cells["cells"].remove(same)
        case 5:
            same["cell_type"] = "markdown"
    return json.dumps(cells).encode(), (0, points[1])


def exported(folder: Path, form: str, of: list[Student]) -> Path:
    """Put what students have handed in into a folder as a learning system exports it; return what is to be graded."""
    folder.mkdir(parents=True)
    for number, student in enumerate(of):
        late = "LATE_" if student.is_late else ""
        moodle = f"Ada {student.name}_{1000 + number}_assignsubmission_file"
        match form:
            case "folders":
                path = folder / student.name / "notebooks" / NAME
            case "canvas":
                path = folder / f"{student.name}_{late}{100 + number}_{9000 + number}_{NAME}"
            case "moodle":
                path = folder / f"{moodle}_" / NAME
            case "moodle_flat":
                path = folder / f"{moodle}_{NAME}"
            case "nbgrader":
                path = folder / "submitted" / student.name / "services" / NAME
            case "zips":
                path = folder / f"{student.name}.zip"
        path.parent.mkdir(parents=True, exist_ok=True)
        if form == "zips":
            with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
                archive.writestr(f"course/notebooks/{NAME}", student.data)
        else:
            path.write_bytes(student.data)
    return folder
