"""Every exercise in its chapter's kernel: a right answer gets all points, a wrong one the right hint."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from typing import Any

import pytest

from course_kit.exercises.catalogue import CHAPTERS
from tests.exercises.chapter import Answers, Chapter, answers_to, chapter, judge

pytestmark = pytest.mark.timeout(400)


@pytest.fixture(scope="module")
def notebook_of() -> Iterator[Callable[[str, str], Chapter]]:
    """Opens the notebook of an exercise's chapter, once for a group: no other group's answers are in its workspace."""
    with ExitStack() as stack:
        opened: dict[str, Chapter] = {}

        def notebook(exercise: str, group: str) -> Chapter:
            if group not in opened:
                stack.close()
                opened.clear()
                opened[group] = stack.enter_context(chapter(exercise.rpartition("-")[0]))
                opened[group].begin(exercise)
            return opened[group]

        yield notebook


@pytest.fixture
def notebook(notebook_of: Callable[[str, str], Chapter], answers: Answers, request: pytest.FixtureRequest) -> Chapter:
    mark = request.node.get_closest_marker("xdist_group")
    return notebook_of(answers.exercise, mark.args[0])


BUILDS = pytest.mark.slow("each answer builds a package")
BY_TURNS = pytest.mark.by_turns("a kernel for each few exercises")
CPU_BOUND = ("actions-5", "robot", "workspace")  # chapters, or exercises, whose answers compute, simulate or build
WAITING = ("robot-5", "robot-7", "workspace-4")  # of those the ones whose checks wait two thirds of their time
FURTHER = pytest.mark.slow("the reference and the first wrong answer show that the check judges")


def row(answers: Answers, number: int, *values: Any, id: str, marks: Sequence[pytest.MarkDecorator] = ()) -> Any:
    """The parameters of one test; those of a group run one after another, in one kernel."""
    marks = [pytest.mark.xdist_group(answers.group(number)), *marks]
    if answers.exercise.startswith(CPU_BOUND) and answers.exercise not in WAITING:
        marks.append(pytest.mark.cpu_bound)
    return pytest.param(answers, *values, id=id, marks=marks)


def every_exercise() -> Iterator[Any]:
    for name in CHAPTERS:
        for answers in answers_to(name):
            yield row(answers, 0, id=answers.exercise)


def every_answer() -> Iterator[Any]:
    for name in CHAPTERS:
        for answers in answers_to(name):
            further = [BUILDS] if name == "workspace" else [FURTHER]
            yield row(answers, 0, answers.reference, answers.points, "", id=f"{answers.exercise}-reference")
            for number, wrong in enumerate(answers.wrong):
                values = wrong.source, wrong.points, wrong.hint
                marks = [] if number == 0 and name != "workspace" else further
                yield row(answers, number, *values, id=f"{answers.exercise}-{wrong.name}", marks=marks)
            for number, (style, source) in enumerate(answers.right.items(), len(answers.wrong)):
                values = source, answers.points, ""
                yield row(answers, number, *values, id=f"{answers.exercise}-right_{style}", marks=further)


@BY_TURNS
@pytest.mark.parametrize("answers", list(every_exercise()))
def test_untouched_is_not_begun(notebook: Chapter, answers: Answers):
    shown = notebook.untouched[answers.exercise]
    assert shown.splitlines()[0].endswith(": not begun"), shown
    assert shown == notebook.committed(answers.exercise)


@BY_TURNS
@pytest.mark.parametrize(("answers", "source", "points", "hint"), list(every_answer()))
def test_answer(notebook: Chapter, answers: Answers, source: str, points: int, hint: str):
    judge(notebook.answer(answers.exercise, source), points, answers.points, hint)


def test_every_exercise_has_three_wrong_answers_at_least():
    few = [one.exercise for name in CHAPTERS for one in answers_to(name) if len(one.wrong) < 3]
    assert few == []


def test_every_exercise_has_three_right_answers_at_least():
    few = [one.exercise for name in CHAPTERS for one in answers_to(name) if len(one.right) < 2]
    assert few == []
