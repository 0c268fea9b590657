"""solution() in a notebook: a worked solution, the reason, and what differs in the student's answer."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

from course_kit.base.arguments import TEXT, shown, takes
from course_kit.exercises import catalogue
from course_kit.exercises.exercise import Exercise
from course_kit.exercises.in_notebook import check, checker_client, checker_environment, progress
from course_kit.exercises.notebook_folder import beside_the_notebook
from course_kit.exercises.protocol.channel import as_json
from course_kit.exercises.solutions import answered, differences, worked
from course_kit.exercises.solutions.worked import Worked


@takes(exercise=TEXT)
def solution(exercise: str) -> None:
    """Show a worked solution of an exercise, such as `solution("topics-1")`, and how your answer differs from it.

    It is there when you have full points, or after three checks of an answer that was begun; before, a line says how
    many are left. Raises ValueError if there is no such exercise.
    """
    asked = catalogue.find(exercise)
    found = worked.find(asked.name)
    if checker_client.GRADER in checker_environment.at_start():
        print("solution: none is shown while an answer is graded.")
    elif found is None:
        print("solution: this edition of the course has no solutions. Your instructor has them.")
    elif left := _tries_left(asked):
        tries = "1 more try" if left == 1 else f"{left} more tries"
        print(
            f"solution: {asked.name} opens with full points or after {tries}. "
            "Until then, the hints of its check say where to look."
        )
    else:
        check.show(Shown(asked, found))


def _tries_left(asked: Exercise) -> int:
    try:
        return progress.tries_left(asked.name, asked.points)
    except progress.Damaged as damaged:
        print(f"solution: {damaged}.")
        return progress.TRIES


class Shown:
    """A solution as it is shown: Markdown, which is also its text."""

    def __init__(self, asked: Exercise, found: Worked) -> None:
        heading = f"**{asked.name} · {asked.title}**: a solution"
        self.text = "\n\n".join([heading, found.numbered.strip(), *_compared(asked, found)])

    def __repr__(self) -> str:
        return self.text

    def _repr_markdown_(self) -> str:
        return self.text


def _compared(asked: Exercise, found: Worked) -> list[str]:
    """What differs in the student's answer, as far as it is there; whatever that is, it raises nothing."""
    told: list[str] = []
    for compare in (_class, _function, _values, _files):
        with contextlib.suppress(Exception):
            told += compare(asked, found)
    items = [each if each.startswith("```") or each.endswith(":") else f"- {each}" for each in told]
    return ["**And yours?**", *items] if items else []


def _class(asked: Exercise, found: Worked) -> Iterator[str]:
    name = asked.node_class
    theirs = answered.class_source(name, found.cells) if name else None
    if name is None or theirs is None:
        return
    mine = answered.class_source(name, answered.cells_run()) if name in check.names() else None
    if mine is None:
        yield f"This notebook has no class `{name}` now: run your answer, and `solution` again, to see what differs."
        return
    yield from differences.of_classes(mine, theirs, check.names()) or [f"Your `{name}` is the same code."]


def _function(asked: Exercise, found: Worked) -> Iterator[str]:
    name = asked.function
    theirs = answered.function_source(name, found.cells) if name else None
    if name is None or theirs is None:
        return
    mine = answered.function_source(name, answered.cells_run()) if name in check.names() else None
    if mine is None:
        yield f"No cell that ran here has `def {name}`: run your answer, and `solution` again, to see what differs."
        return
    yield from differences.of_functions(mine, theirs) or [f"Your `{name}` is the same code."]


def _values(asked: Exercise, found: Worked) -> Iterator[str]:
    for name, value in answered.plain_values(found.code) if asked.value else ():
        mine = check.names().get(name)
        if as_json(mine) != as_json(value):
            yield f"Your `{name}` is `{shown(mine)}`, the solution's `{shown(value)}`."


def _files(asked: Exercise, found: Worked) -> Iterator[str]:
    folder = beside_the_notebook(Path(os.getcwd()))
    for name, theirs in found.files.items():
        if not (path := folder / name).is_file():
            yield f"There is no `{name}` yet."
            continue
        mine = path.read_text(encoding="utf-8", errors="replace")
        if told := differences.of_files(mine, theirs):
            yield f"`{name}`:"
            yield from told
