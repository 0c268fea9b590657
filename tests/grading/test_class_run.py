"""When an exercise is checked again, alone; what is kept; that equal answers are graded once."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any

import pytest

from course_kit.classroom.collect.handins import HandIn
from course_kit.classroom.results import ExerciseResult, StudentResult
from course_kit.classroom.run import class_run
from course_kit.classroom.run.class_run import BUSY, ClassRun
from course_kit.classroom.run.notebook_run import Found, Settings
from course_kit.classroom.run.submission import Submission, Work
from course_kit.exercises.protocol.verdict import LOOKED_AT, NOT_LOOKED_AT, Finding, Verdict


class Recorded(Executor):
    """Gives what grading has found in earlier runs, and notes what was asked for."""

    def __init__(self, *runs: Found) -> None:
        self.runs = list(runs)
        self.asked: list[tuple[str, ...]] = []

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        work: Work = args[0]
        self.asked.append(work.only)
        future: Future[Any] = Future()
        future.set_result({work.only[0]: self.runs.pop(0)})
        return future


def found(points: int, stalled: float = 0.0, state: str = LOOKED_AT, is_late: bool = False) -> Found:
    verdict = Verdict("topics-2", "", 2, state, (Finding("", points > 0, "", 1), Finding("", points > 1, "", 1)))
    return Found(ExerciseResult(verdict), stalled, is_late)


def submitted(student: str, source: str = "x = 1") -> Submission:
    return Submission(HandIn(student, {}), (Work("topics", {"topics-2": source}, ("topics-2",)),), ())


def graded(executor: Recorded, *of: Submission, folder: Path | None = None) -> list[StudentResult]:
    told: list[StudentResult] = []
    results = ClassRun(Settings(), 1, folder, executor).grade(of, told.append)
    assert sorted(told, key=lambda one: one.student) == sorted(results, key=lambda one: one.student)
    return results


@pytest.mark.parametrize(
    ("first", "alone", "points", "tries"),
    [
        (found(2, stalled=1.0), None, 2, 1),
        (found(1, stalled=BUSY), None, 1, 1),
        (found(1, stalled=BUSY + 0.1), found(2), 2, 2),
        (found(1, stalled=BUSY + 0.1), found(0), 1, 2),
        (found(0, is_late=True), found(0), 0, 2),
        (found(0, state=NOT_LOOKED_AT, is_late=True), found(2), 2, 2),
    ],
    ids=["full", "calm", "busy", "busy and no better", "late", "not looked at"],
)
def test_what_may_have_wanted_time_is_checked_again_alone(first: Found, alone: Found | None, points: int, tries: int):
    executor = Recorded(first, *([alone] if alone else []))
    (result,) = graded(executor, submitted("ada"))
    assert (result.points, result.exercises[0].tries) == (points, tries)
    assert len(executor.asked) == tries


def test_equal_answers_are_graded_once_and_each_student_has_them():
    executor = Recorded(found(2))
    assert [one.points for one in graded(executor, submitted("ada"), submitted("bob"))] == [2, 2]
    assert len(executor.asked) == 1


def test_what_is_kept_is_used_again_unless_it_is_damaged_or_could_not_be_looked_at(tmp_path: Path):
    assert graded(Recorded(found(1)), submitted("ada"), folder=tmp_path)[0].points == 1
    assert graded(Recorded(), submitted("ada"), folder=tmp_path)[0].points == 1
    (kept,) = (tmp_path / class_run.KEPT).iterdir()
    for damage in ("", "{}", "[]", '{"format": 1, "found": {"topics-2": 3}}'):
        kept.write_text(damage)
        assert graded(Recorded(found(2)), submitted("ada"), folder=tmp_path)[0].points == 2
    failed = found(0, state=NOT_LOOKED_AT, is_late=True)
    assert graded(Recorded(failed, failed), submitted("bob", "y = 1"), folder=tmp_path)[0].points == 0
    assert graded(Recorded(found(2)), submitted("bob", "y = 1"), folder=tmp_path)[0].points == 2


def test_the_course_the_answers_and_what_is_asked_for_decide_what_is_new():
    chapter = class_run.reference.chapters()[2]
    work = Work("topics", {"topics-2": "x = 1"}, ("topics-2",))
    others = [
        work.digest(chapter, "another course"),
        Work("topics", {"topics-2": "x = 2"}, ("topics-2",)).digest(chapter, "course"),
        Work("topics", {"topics-2": "x = 1"}, ("topics-2", "topics-3")).digest(chapter, "course"),
        Work("topics", {"topics-2": "x = 1"}, ("topics-2",), {"a": b""}).digest(chapter, "course"),
        work.digest(class_run.reference.chapters()[3], "course"),
    ]
    assert len({work.digest(chapter, "course"), *others}) == 6
