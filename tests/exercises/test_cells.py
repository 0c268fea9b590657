"""The cells of every exercise say the same as its declaration, and its check cell is committed as not begun."""

from __future__ import annotations

import re
from pathlib import Path

import nbformat
import pytest

from course_kit.exercises import catalogue
from course_kit.exercises.checker import checks
from course_kit.exercises.exercise import Exercise
from course_kit.exercises.solutions import worked
from tests.exercises.chapter import FOLDER

PATHS = sorted(FOLDER.glob("[0-9][0-9]_*.ipynb"))
CELLS = {
    (cell.metadata.course_kit.role, cell.metadata.course_kit.exercise): cell
    for path in PATHS
    for cell in nbformat.read(path, as_version=4).cells
    if "exercise" in cell.metadata.get("course_kit", {})
}


@pytest.mark.parametrize("exercise", catalogue.EXERCISES, ids=lambda one: one.name)
def test_the_cells_say_what_the_declaration_says(exercise: Exercise):
    text = CELLS["exercise", exercise.name].source
    number = exercise.name.rsplit("-", 1)[1]
    word = "point" if exercise.points == 1 else "points"
    title, stated = text.splitlines()[:2]
    assert title == f"### Exercise {number} · {exercise.title}"
    level, points = exercise.level.capitalize(), f"{exercise.points} {word}"
    assert re.fullmatch(rf"\*{level}, about [1-9]\d? minutes, {points}\*", stated)
    if exercise.node_class:
        assert f"`{exercise.node_class}`" in text
    for role in ("exercise", "answer", "check"):
        assert CELLS[role, exercise.name].metadata.course_kit.points == exercise.points
    check = CELLS["check", exercise.name]
    assert check.source.endswith(")") and f'check("{exercise.name}"' in check.source
    assert "nbval-ignore-output" not in check.metadata.get("tags", [])
    assert check.outputs[0]["data"]["text/plain"].splitlines()[0].endswith(": not begun")


@pytest.mark.parametrize("exercise", catalogue.EXERCISES, ids=lambda one: one.name)
def test_check_solution_and_answers_stand_in_the_folders_of_the_chapter(exercise: Exercise):
    check = f"{exercise.name.replace('-', '_')}_*.py"
    code, answers = (folder / exercise.chapter for folder in (worked.EXERCISES, Path(__file__).parent))
    assert [len(list(folder.glob(check))) for folder in (code, answers)] == [1, 1]
    assert (code / worked.FOLDER / f"{exercise.name}.md").is_file()
    assert callable(checks.find(exercise).judge)


def test_every_check_is_of_an_exercise():
    for chapter in catalogue.CHAPTERS:
        assert len(checks.of_chapter(chapter)) == len(catalogue.of_chapter(chapter)) > 0
