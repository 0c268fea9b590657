"""The student's points and tries: a file that outlives kernels, read and written as a whole. Pure: no ROS.

It lies where programs keep their state: $XDG_STATE_HOME, or ~/.local/state.
"""

from __future__ import annotations

import html
import itertools
import json
import os
from collections.abc import Iterable, Iterator
from pathlib import Path

from course_kit.base.atomic_files import set_aside, write_whole
from course_kit.base.file_locks import locked
from course_kit.exercises import catalogue
from course_kit.exercises.exercise import Exercise
from course_kit.exercises.protocol.verdict import LOOKED_AT, Verdict

FOLDER, FILE = "ros2-notebook-course", "progress.json"
LOCK_TIMEOUT = 5.0  # seconds; who keeps it longer stands still
TRIES = 3  # checks of an answer, none of them with full points, after which its solution may be seen


def path() -> Path:
    """The file."""
    state = os.environ.get("XDG_STATE_HOME", "")
    base = Path(state) if os.path.isabs(state) else Path.home() / ".local" / "state"
    return base / FOLDER / FILE


class Damaged(ValueError):  # noqa: N818  (reads as what happened)
    """The file is there, but holds no points that can be read."""


def load() -> dict[str, int]:
    """The best points so far, by exercise; none without a file. Raises Damaged."""
    return _load()[0]


def tries_left(exercise: str, max_points: int) -> int:
    """How many checks of an answer are to come before the solution may be seen; 0 with full points. Raises Damaged."""
    points, tries = _load()
    is_solved = points.get(exercise, 0) >= max_points
    return 0 if is_solved else max(0, TRIES - tries.get(exercise, 0))


def _load() -> tuple[dict[str, int], dict[str, int]]:
    """The best points and the checks without full points, by exercise. Raises Damaged."""
    try:
        file = path()
    except RuntimeError:  # no home
        return {}, {}
    try:
        kept = json.loads(file.read_text())
        points, tries = kept["points"], kept.get("tries", {})  # which an older course did not count
        return {str(name): int(got) for name, got in points.items()}, {str(n): int(c) for n, c in tries.items()}
    except FileNotFoundError:  # none yet
        return {}, {}
    # OverflowError: of Infinity, which Python's JSON has. RecursionError: of [[[[…
    except (OSError, ValueError, TypeError, AttributeError, KeyError, OverflowError, RecursionError) as error:
        raise Damaged(f"your earlier points cannot be read from {file}, which is damaged ({error!r})") from None


def record(verdict: Verdict) -> str:
    """Keep a verdict's points if they are the best so far, and count it if they are not full.

    It returns what the student must be told, or nothing.

    A damaged file is kept under another name. Raises OSError where the file cannot be written or stays locked.
    """
    if verdict.state != LOOKED_AT:
        return ""
    try:
        file = path()
    except RuntimeError as error:  # there is no home
        raise OSError(str(error)) from None
    with locked(file.parent / "lock", LOCK_TIMEOUT):  # two notebooks may record at the same time
        points, tries, notice = dict[str, int](), dict[str, int](), ""
        try:
            points, tries = _load()
        except Damaged as damaged:
            notice = f"{damaged}. It is now {set_aside(file).name}, and points are counted anew."
        is_best = points.get(verdict.exercise, -1) < verdict.points
        if is_best or not verdict.is_full:
            points[verdict.exercise] = max(verdict.points, points.get(verdict.exercise, 0))
            tries[verdict.exercise] = tries.get(verdict.exercise, 0) + (not verdict.is_full)
            kept = {"points": dict(sorted(points.items())), "tries": dict(sorted(tries.items()))}
            text = json.dumps(kept, indent=1) + "\n"
            write_whole(file, text.encode(), mode=0o600)
        return notice


WIDTH = 20


class Progress:
    """What is solved, in all and by chapter: as text, and in a notebook drawn as bars."""

    def __init__(self, at_hand: str = "") -> None:
        """`at_hand`: the chapter that comes first, by its key in CHAPTERS; the others follow in their order."""
        self._order = sorted(catalogue.CHAPTERS, key=lambda chapter: chapter != at_hand)
        self._notice = ""
        try:
            self.points = load()
        except Damaged as damaged:
            self.points, self._notice = {}, f"{str(damaged)[0].upper()}{str(damaged)[1:]}."

    def _chapters(self) -> Iterator[tuple[str, int, int, list[tuple[Exercise, int]]]]:
        """The course, then every chapter: its title, the points, of how many, and its exercises with their points."""
        solved = {chapter: [self._solved(one) for one in catalogue.of_chapter(chapter)] for chapter in self._order}
        yield "The course", *_total(itertools.chain(*solved.values())), []
        for chapter, of_it in solved.items():
            yield catalogue.CHAPTERS[chapter], *_total(of_it), of_it

    def _solved(self, one: Exercise) -> tuple[Exercise, int]:
        """An exercise and the points that it has."""
        return one, min(one.points, self.points.get(one.name, 0))

    def __repr__(self) -> str:
        lines = [self._notice] if self._notice else []
        for title, points, max_points, solved in self._chapters():
            filled = round(WIDTH * points / max_points)
            lines.append(f"{title:20} {'█' * filled}{'·' * (WIDTH - filled)} {points:3} of {max_points} points")
            for each, got in solved:
                mark = "✔" if got == each.points else "◐" if got else "○"
                lines.append(f"  {mark} {each.name:12} {each.title:34} {got} of {each.points}   {each.level}")
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        rows = [f"<tr><td colspan='3'>{html.escape(self._notice)}</td></tr>"] if self._notice else []
        left = "style='text-align:left;overflow-wrap:anywhere'"
        for title, points, max_points, solved in self._chapters():
            rows.append(f"<tr><th {left}>{title}</th>{_bar(title, points, max_points, '10em')}</tr>")
            for each, got in solved:
                name = f"{each.name} · {each.title}"
                rows.append(f"<tr><td {left}>&emsp;{name}</td>{_bar(name, got, each.points, '5em')}</tr>")
        return f"<table class='course-kit-progress' style='table-layout:auto'>{''.join(rows)}</table>"


def _total(solved: Iterable[tuple[Exercise, int]]) -> tuple[int, int]:
    """The points, and of how many."""
    both = [(got, each.points) for each, got in solved]
    return sum(got for got, _ in both), sum(points for _, points in both)


def _bar(name: str, points: int, max_points: int, width: str) -> str:
    """Two cells of the table: points as a bar, and in words."""
    style = f"style='width:{width};max-width:20vw'"
    return (
        f"<td><progress aria-label='{html.escape(name, quote=True)}' max='{max_points}' value='{points}' {style}>"
        f"</progress></td><td style='white-space:nowrap'>{points} of {max_points}</td>"
    )
