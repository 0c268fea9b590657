"""The report of grading in the terminal: a line a student, a table of the class, verdicts. Pure: no ROS."""

from __future__ import annotations

from collections.abc import Sequence

from course_kit.base import text
from course_kit.classroom.plain_text import plain
from course_kit.classroom.report.gradebook import name_of, not_looked_at
from course_kit.classroom.results import ExerciseResult, StudentResult
from course_kit.exercises.protocol.verdict import NOT_LOOKED_AT, points_text

LONGEST_NAME = 32  # characters of a student's name
OPEN = "?"  # behind points that may grow: the checker failed on an exercise


def by_chapter(result: StudentResult) -> dict[str, list[ExerciseResult]]:
    """A student's exercises by chapter, in the order of the course."""
    chapters: dict[str, list[ExerciseResult]] = {}
    for each in result.exercises:
        chapters.setdefault(each.verdict.exercise.rpartition("-")[0], []).append(each)
    return chapters


def points_of(exercises: Sequence[ExerciseResult]) -> tuple[int, int]:
    """The points that exercises have, and those that there are."""
    return sum(each.verdict.points for each in exercises), sum(each.verdict.max_points for each in exercises)


def line(result: StudentResult) -> str:
    """One line about a student: points, also by chapter, and what is odd."""
    chapters = [f"{name} {'/'.join(map(str, points_of(of)))}" for name, of in by_chapter(result).items()]
    odd = [late(result), *(f"could not look at {name}" for name in not_looked_at(result))]
    points = points_text(result.points, result.max_points)
    parts = [f"{_short(name_of(result))}: {points}", *(chapters if len(chapters) > 1 else []), *odd]
    return " · ".join(filter(None, parts))


def table(results: Sequence[StudentResult]) -> str:
    """The class as a table: a column a chapter, or an exercise where there is one chapter; at its foot the means."""
    if not results:
        return "There are no hand-ins."
    several = len({chapter for result in results for chapter in by_chapter(result)}) > 1
    columns = [by_chapter(r) if several else {e.verdict.exercise: [e] for e in r.exercises} for r in results]
    heads = list(dict.fromkeys(head for of_one in columns for head in of_one))
    most = [max(points_of(of_one.get(head, []))[1] for of_one in columns) for head in heads]
    rows = [
        ["student", *heads, "total", "%", ""],
        ["  of", *map(str, most), str(max(result.max_points for result in results)), "", ""],
    ]
    for result, of_one in zip(results, columns, strict=True):
        points = [_points(of_one[head]) if head in of_one else "" for head in heads]
        rows.append([_short(name_of(result)), *points, _points(result.exercises), _percent([result]), late(result)])
    # Who has open points is left out of the means.
    known = [(r, of_one) for r, of_one in zip(results, columns, strict=True) if not not_looked_at(r)]
    means = [_mean([points_of(of_one[head])[0] for _, of_one in known if head in of_one]) for head in heads]
    rows.append(["  mean", *means, _mean([r.points for r, _ in known]), _percent([r for r, _ in known]), ""])
    return text.table(rows)


def verdicts(result: StudentResult) -> str:
    """What was found of each exercise, and the points of all."""
    found = [f"{each.verdict}\n" for each in result.exercises]
    odd = [f"! {note}" for note in ["handed in late"] * result.late + list(result.notes)]
    odd += [f"! {name} could not be looked at: its points are open" for name in not_looked_at(result)]
    return plain("\n".join([*found, *odd, f"{name_of(result)}: {points_text(result.points, result.max_points)}"]))


def late(result: StudentResult) -> str:
    """The word for it, or nothing."""
    return "late" if result.late else ""


def _points(exercises: Sequence[ExerciseResult]) -> str:
    is_open = any(each.verdict.state == NOT_LOOKED_AT for each in exercises)
    return f"{points_of(exercises)[0]}{OPEN if is_open else ''}"


def _percent(results: Sequence[StudentResult]) -> str:
    most = sum(result.max_points for result in results)
    return f"{100 * sum(result.points for result in results) / most:.0f}" if most else ""


def _mean(points: Sequence[int]) -> str:
    return f"{sum(points) / len(points):.1f}" if points else ""


def _short(name: str) -> str:
    name = " ".join(plain(name).split())
    return name if len(name) <= LONGEST_NAME else f"{name[: LONGEST_NAME - 1]}…"
