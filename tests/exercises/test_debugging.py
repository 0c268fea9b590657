"""Chapter 6's exercises: the right answers get all points, the wrong ones lose theirs with the right hint."""

from __future__ import annotations

import pytest

from tests.exercises.answers_debugging import ANSWERS, CELLS, PREPARE
from tests.exercises.chapter import Answers, Chapter, chapter, expected, judge


@pytest.fixture(scope="module")
def notebook():
    with chapter("06_debugging", CELLS, PREPARE) as made:
        yield made
        made.kernel.run("faults.stop(); stop()")


@pytest.mark.timeout(180)
@pytest.mark.parametrize("answers", ANSWERS, ids=lambda a: a.exercise)
def test_untouched_is_not_begun(notebook: Chapter, answers: Answers):
    shown = notebook.answer(answers.exercise, notebook.source("answer", answers.exercise))
    assert shown.splitlines()[0].endswith(": not begun"), shown
    assert shown == notebook.committed(answers.exercise)


@pytest.mark.timeout(240)
@pytest.mark.parametrize(("exercise", "source", "points", "of", "hint"), expected(ANSWERS))
def test_answer(notebook: Chapter, exercise: str, source: str, points: int, of: int, hint: str):
    judge(notebook.answer(exercise, source), points, of, hint)
