"""Grading as pages that need nothing else: one for each student, one for the class. Pure: no ROS."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from urllib.parse import quote

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from course_kit.base.atomic_files import write_whole
from course_kit.classroom.plain_text import plain
from course_kit.classroom.report import gradebook
from course_kit.classroom.report.table import by_chapter, points_of
from course_kit.classroom.results import ExerciseResult, StudentResult
from course_kit.exercises.catalogue import CHAPTERS
from course_kit.exercises.protocol.verdict import LOOKED_AT, NOT_BEGUN, NOT_LOOKED_AT, Verdict, in_code, points_text

FOLDER = "feedback"
MOST_HINTS = 15
# What differs between two who made the same mistake: what is quoted, and numbers. An apostrophe quotes nothing,
# and the number in a name such as turtle1 is a part of it.
_QUOTED = re.compile(r"(?<!\w)'[^'\n]*'(?!\w)|\"[^\"\n]*\"|“[^”\n]*”")
_NUMBER = re.compile(r"(?<![A-Za-z])-?\d+(?:[.,]\d+)*")


def write(results: Sequence[StudentResult], folder: Path, title: str) -> list[Path]:
    """Write a page for each student and class.html, in a folder of theirs; return them."""
    names = gradebook.file_names(results)
    pages = {f"{names[result.student]}.html": _student_page(result, title) for result in results}
    pages["class.html"] = _class_page(results, names, title)
    return [write_whole(folder / FOLDER / name, page.encode()) for name, page in pages.items()]


@cache
def _templates() -> Environment:
    templates = Environment(
        loader=FileSystemLoader(Path(__file__).with_name("templates")),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        finalize=lambda value: plain(value) if type(value) is str else value,
    )
    templates.filters["code"] = lambda text: Markup(in_code(plain(text)))
    templates.globals.update(
        {"LOOKED_AT": LOOKED_AT, "NOT_BEGUN": NOT_BEGUN, "NOT_LOOKED_AT": NOT_LOOKED_AT, "points_text": points_text},
        points_of=points_of,
        percent=_percent,
        tried=_tried,
    )
    return templates


def _student_page(result: StudentResult, title: str) -> str:
    chapters = {CHAPTERS.get(name, name): exercises for name, exercises in by_chapter(result).items()}
    name, open_ones = gradebook.name_of(result), gradebook.not_looked_at(result)
    page = _templates().get_template("student.html")
    return page.render(title=title, result=result, name=name, chapters=chapters, open_ones=open_ones)


def _class_page(results: Sequence[StudentResult], names: dict[str, str], title: str) -> str:
    from course_kit.classroom.report import feedback_plots  # matplotlib takes its time

    exercises = _exercises(results)
    hardest = sorted(exercises, key=lambda each: each.percent)  # those alike in the order of the course
    return (
        _templates()
        .get_template("class.html")
        .render(
            title=title,
            results=results,
            links={student: f"{quote(name)}.html" for student, name in names.items()},
            names={result.student: gradebook.name_of(result) for result in results},
            chapters=list(dict.fromkeys(chapter for result in results for chapter in by_chapter(result))),
            by_chapter={result.student: by_chapter(result) for result in results},
            open_ones={result.student: gradebook.not_looked_at(result) for result in results},
            counts=_counts(results),
            spread=feedback_plots.spread([_percent(r.points, r.max_points) for r in results]) if results else "",
            shares=feedback_plots.shares([(each.name, each.percent) for each in hardest]) if hardest else "",
            exercises=hardest,
            hints=_hints(results)[:MOST_HINTS],
            protection=gradebook.protection(results),
        )
    )


def _percent(points: float, max_points: float) -> float:
    return 100 * points / max_points if max_points else 0.0


@dataclass(frozen=True)
class _OfClass:
    """One exercise, of the class."""

    verdicts: Sequence[Verdict]

    @property
    def name(self) -> str:
        return self.verdicts[0].exercise

    @property
    def title(self) -> str:
        return self.verdicts[0].title

    @property
    def max_points(self) -> int:
        return self.verdicts[0].max_points

    @property
    def mean(self) -> float:
        """Of all who may have solved it: the checker's own failures say nothing about it."""
        known = [verdict.points for verdict in self.verdicts if verdict.state != NOT_LOOKED_AT]
        return sum(known) / len(known) if known else 0.0

    @property
    def percent(self) -> float:
        return _percent(self.mean, self.max_points)

    @property
    def full(self) -> int:
        return sum(verdict.is_full for verdict in self.verdicts)

    def count(self, state: str) -> int:
        return sum(verdict.state == state for verdict in self.verdicts)


def _exercises(results: Sequence[StudentResult]) -> list[_OfClass]:
    verdicts: dict[str, list[Verdict]] = {}
    for verdict in _verdicts(results):
        verdicts.setdefault(verdict.exercise, []).append(verdict)
    return [_OfClass(of_one) for of_one in verdicts.values()]


def _verdicts(results: Sequence[StudentResult]) -> list[Verdict]:
    return [each.verdict for result in results for each in result.exercises]


def _counts(results: Sequence[StudentResult]) -> dict[str, int]:
    """What is counted about the hand-ins, by what it is called."""
    states = [verdict.state for verdict in _verdicts(results)]
    missing = [r for r in results if all(each.verdict.state == NOT_BEGUN for each in r.exercises)]
    return {
        "students": len(results),
        "handed in late": sum(result.late for result in results),
        "missing: no exercise begun": len(missing),
        "answers that were looked at": states.count(LOOKED_AT),
        "exercises not begun": states.count(NOT_BEGUN),
        "answers that could not be looked at": states.count(NOT_LOOKED_AT),
    }


@dataclass(frozen=True)
class _Hint:
    """What several students were told about one exercise, without what differed."""

    exercise: str
    text: str
    students: list[str]


def _hints(results: Sequence[StudentResult]) -> list[_Hint]:
    """The hints that were given, the commonest first. Who got one twice counts once."""
    given: dict[tuple[str, str], dict[str, None]] = {}
    for result in results:
        for verdict in (each.verdict for each in result.exercises):
            for finding in verdict.findings:
                if not finding.ok:
                    told = verdict.exercise, _alike(finding.hint or finding.text)
                    given.setdefault(told, {})[result.student] = None
    hints = [_Hint(exercise, text, list(students)) for (exercise, text), students in given.items()]
    return sorted(hints, key=lambda hint: (-len(hint.students), hint.exercise, hint.text))


def _alike(text: str) -> str:
    """A hint without what differs between those who made the same mistake."""
    values = _NUMBER.sub("…", _QUOTED.sub("…", " ".join(plain(text).split())))
    return re.sub(r"…(?:,? ?…)+", "…", values)  # lists of them, long or short


def _tried(each: ExerciseResult) -> str:
    """How often an answer was checked, in words."""
    times = "once" if each.tries == 1 else f"{each.tries} times"
    return f"checked {times}, in {each.seconds:.1f} s"
