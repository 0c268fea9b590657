"""Cheats with what is handed in: cells, outputs, tags, ids, further notebooks and files, names, zips."""

from __future__ import annotations

import copy
import io
import json
import os
import stat
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import nbformat

from course_kit.exercises.notebooks.reference import ANSWER, CHECK, mark_of
from tests.cheats.cheat import WRONG_REPORT
from tests.exercises.setup.setup_1_report import REPORT
from tests.grading.handed_in import CHAPTERS, notebook

NAME = CHAPTERS["setup"].file
FULL = "setup-1 · Read the report: 1 of 1 point\n"
Change = Callable[[Any], Any]


@dataclass(frozen=True)
class HandedIn:
    """What several students, or one, hand in, and the points of each."""

    name: str
    tries: str  # to do what, in a sentence
    write: Callable[[Path], object]  # puts it into a folder
    points: Mapping[str, int]  # by student
    told: str = ""  # that must stand in a note
    asked: tuple[str, ...] = ("setup-1",)
    by_default: bool = False
    seconds: int = 300  # after which the test has hung


def _made(answer: str = WRONG_REPORT, change: Change = lambda made: None) -> bytes:
    """The notebook with an answer to setup-1, after a change."""
    made = notebook("setup", {"setup-1": answer})
    change(made)
    return json.dumps(made).encode()  # nbformat would mend ids that are there twice


def _put(files: Callable[[], Mapping[str, bytes]]) -> Callable[[Path], object]:
    """Write the files that a call makes: a broken change breaks its own test only, and collecting costs nothing."""

    def write(folder: Path) -> None:
        for name, data in files().items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)

    return write


def _one(name: str, tries: str, change: Change, answer: str = WRONG_REPORT, **rest: Any) -> HandedIn:
    """What one student has done to the notebook, whose answer is wrong; it gets nothing."""
    return HandedIn(name, tries, _put(lambda: {f"eve/{NAME}": _made(answer, change)}), {"eve": 0}, **rest)


def _cell(made: Any, role: str, exercise: str = "setup-1") -> Any:
    return next(c for c in made.cells if (mark_of(c).get("role"), mark_of(c).get("exercise")) == (role, exercise))


def _tags(made: Any) -> None:
    for cell in made.cells:
        cell.metadata["tags"] = ["raises-exception", "nbval-skip", "nbval-ignore-output", "skip-execution"]
    made.metadata["kernelspec"] = {"name": "bash", "display_name": "bash", "language": "bash"}


def _markdown(made: Any) -> None:
    for number, cell in enumerate(made.cells):
        if mark_of(cell).get("role") == CHECK:
            made.cells[number] = nbformat.v4.new_markdown_cell(cell.source, id=cell.id, metadata=cell.metadata)


def _outputs(made: Any) -> None:
    check = _cell(made, CHECK)
    check.outputs = [nbformat.v4.new_output("stream", name="stdout", text=FULL)]
    _cell(made, ANSWER).outputs = check.outputs


def _cleared(made: Any) -> None:
    for cell in made.cells:
        if cell.cell_type == "code":
            cell.outputs, cell.execution_count = [], None


def _false_check(made: Any) -> None:
    check = _cell(made, CHECK)
    check.source = f"print({FULL.strip()!r})"
    for cell in made.cells:
        if mark := cell.metadata.get("course_kit"):
            mark["points"] = 99
            mark["role"] = "prerequisite" if mark["role"] == CHECK else mark["role"]


def _twice(made: Any) -> None:
    again = copy.deepcopy(_cell(made, ANSWER))
    again.source = REPORT
    made.cells.append(again)


def _swapped(made: Any) -> None:
    one, other = _cell(made, ANSWER), _cell(made, ANSWER, "setup-2")
    one.id, other.id = other.id, one.id


def _no_id(made: Any) -> None:
    _cell(made, ANSWER).id = "another-id"


def _own_cells(made: Any) -> None:
    begin = nbformat.v4.new_code_cell(f"import course_kit; course_kit.check = lambda *a: print({FULL!r})")
    prerequisite = {"course_kit": {"role": "prerequisite", "part": "all"}}
    made.cells.insert(0, nbformat.v4.new_code_cell(begin.source, metadata=prerequisite))
    made.cells.insert(0, begin)


def _zipped(members: Mapping[str, bytes], links: Mapping[str, str] | None = None) -> bytes:
    """A zip; links are of the kind that Unix has."""
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as made:
        for name, content in members.items():
            made.writestr(name, content)
        for name, target in (links or {}).items():
            info = zipfile.ZipInfo(name)
            info.create_system, info.external_attr = 3, (stat.S_IFLNK | 0o777) << 16
            made.writestr(info, target)
    return data.getvalue()


def _links(folder: Path) -> None:
    """The right answer of another student by a link, and a folder that is one."""
    _put(lambda: {f"ada/{NAME}": _made(REPORT), "eve/readme.txt": b""})(folder)
    os.symlink(folder / "ada" / NAME, folder / "eve" / NAME)
    _put(lambda: {f"mallory/{NAME}": _made()})(folder)
    os.symlink(folder / "ada", folder / "mallory/notebooks")


BAD = b"import os\nos._exit(0)\n"
ENVIRONMENT = {
    f"eve/{name}": BAD
    for name in ("conftest.py", "course_kit.py", "rclpy.py", "sitecustomize.py", "usercustomize.py", "pytest.py")
} | {
    "eve/pytest.ini": b"[pytest]\naddopts = --collect-only\n",
    "eve/found.jsonl": b'{"found": "setup-1", "verdict": {"points": 1}}\n',
    "eve/job.json": b"{}",
    "eve/.local/state/ros2-notebook-course/progress.json": b'{"points": {"setup-1": 1}}',
    "eve/ros2_ws/src/course_kit/__init__.py": BAD,
    "eve/.ipython/profile_default/startup/00.py": BAD,
}
FORMULAS = ("=cmd|' -C calc'!A0", "+1+1", "@SUM(A1)", "-2+3", '=HYPERLINK("x")', "<script>alert(1)<", "%TEMP%")
DEEP = b'{"cells": ' + b"[" * 100_000 + b"]" * 100_000 + b"}"
CHEATS = [
    _one("tags", "Have cells skipped and errors expected, with another kernel.", _tags),
    _one("markdown_checks", "Make text of the check cells.", _markdown),
    _one("forged_outputs", "Save the output of all points in the check cell.", _outputs),
    _one("cleared_outputs", "Clear the outputs that are compared.", _cleared),
    _one("false_check", "Write another check cell, with 99 points.", _false_check, by_default=True),
    _one("own_cells", "Add cells that replace check().", _own_cells, told="left out"),
    _one("answer_twice", "Have the answer cell twice, once with a right answer.", _twice, told="is there 2 times"),
    _one("swapped_ids", "Let the ids of two answer cells change places.", _swapped, REPORT),
    _one("no_id", "Give the answer cell another id.", _no_id, REPORT, told="is missing"),
    HandedIn(
        "files_beside",
        "Hand in what would be loaded: modules, settings, points, a job.",
        _put(lambda: {**ENVIRONMENT, f"eve/{NAME}": _made()}),
        {"eve": 0},
    ),
    HandedIn(
        "honest_beside_bad_files",
        "The same beside a right answer, which keeps its point.",
        _put(lambda: {**ENVIRONMENT, f"eve/{NAME}": _made(REPORT)}),
        {"eve": 1},
    ),
    HandedIn(
        "formulas",
        "Have names that a spreadsheet or a page takes for commands.",
        _put(lambda: {f"{name}/{NAME}": _made() for name in FORMULAS}),
        {name: 0 for name in FORMULAS},
    ),
    HandedIn(
        "paths_in_zips",
        "Have a zip write outside of its folder, or read what it links to.",
        _put(
            lambda: {
                f"ada/{NAME}": _made(REPORT),
                "eve.zip": _zipped(
                    {f"../../x/{NAME}": _made(REPORT), f"/tmp/x/{NAME}": _made(REPORT), "a\\..\\..\\x": b"x"},
                    {NAME: f"../ada/{NAME}", "ros2_ws": "/etc"},
                ),
            }
        ),
        {"ada": 1, "eve": 0},
    ),
    HandedIn("links", "Hand in links to another student's work.", _links, {"ada": 1, "eve": 0, "mallory": 0}),
    HandedIn(
        "no_notebooks",
        "Hand in what breaks whoever reads it, beside an honest student.",
        _put(
            lambda: {
                f"ada/{NAME}": _made(REPORT),
                f"deep/{NAME}": DEEP,
                f"empty/{NAME}": b"",
                f"odd/{NAME}": b'{"cells": {"id": 1}}',
                f"bytes/{NAME}": b"\xff\xfe\x00",
                f"halves/{NAME}": _made(REPORT + "# @@").replace(b"@@", b"\\ud800 \\u0000"),
                "bomb.zip": _zipped({NAME: b"0" * 300_000_000}),
            }
        ),
        {"ada": 1, "bomb": 0, "bytes": 0, "deep": 0, "empty": 0, "halves": 0, "odd": 0},
    ),
]
