"""What a student has solved: a file of theirs that outlives kernels, read and written as a whole. Pure: no ROS.

It lies where programs keep their state: $XDG_STATE_HOME, or ~/.local/state.
"""

from __future__ import annotations

import fcntl
import html
import itertools
import json
import os
from collections.abc import Iterator
from pathlib import Path

from course_kit import exercises
from course_kit.examining.exercise import Exercise
from course_kit.examining.verdict import LOOKED_AT, Verdict
from course_kit.whole_files import write_whole

FOLDER, FILE = "ros2-notebook-course", "progress.json"


def path() -> Path:
    """The file."""
    state = os.environ.get("XDG_STATE_HOME", "")
    base = Path(state) if os.path.isabs(state) else Path.home() / ".local" / "state"
    return base / FOLDER / FILE


class Damaged(ValueError):  # noqa: N818  (reads as what happened)
    """The file is there, but holds no points that can be read."""


def load() -> dict[str, int]:
    """The best points so far, by exercise; none without a file. Raises Damaged."""
    try:
        file = path()
        points = json.loads(file.read_text())["points"]
        return {str(name): int(got) for name, got in points.items()}
    except (FileNotFoundError, RuntimeError):  # none yet, or no home
        return {}
    except (OSError, ValueError, TypeError, AttributeError, KeyError) as error:
        raise Damaged(f"your earlier points cannot be read from {file}, which is damaged ({error!r})") from None


def record(verdict: Verdict) -> str:
    """Keep a verdict's points if they are the best so far; return what the student must be told, or nothing.

    A damaged file is kept under another name. Raises OSError where the file cannot be written.
    """
    if verdict.state != LOOKED_AT:
        return ""
    try:
        file = path()
    except RuntimeError as error:  # there is no home
        raise OSError(str(error)) from None
    file.parent.mkdir(parents=True, exist_ok=True)
    with open(file.parent / "lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # two notebooks may record at the same time
        points, notice = {}, ""
        try:
            points = load()
        except Damaged as damaged:
            notice = f"{damaged}. It is now {_set_aside(file)}, and points are counted anew."
        if points.get(verdict.exercise, -1) < verdict.points:
            points[verdict.exercise] = verdict.points
            text = json.dumps({"points": dict(sorted(points.items()))}, indent=1) + "\n"
            write_whole(file, text.encode(), mode=0o600)
        return notice


def _set_aside(file: Path) -> str:
    """Give a damaged file a name of its own, which is returned: whoever knows how may mend it."""
    names = (file.with_name(f"{file.stem}.damaged-{number}{file.suffix}") for number in itertools.count(1))
    aside = next(name for name in names if not name.exists())
    return file.rename(aside).name


WIDTH = 20


class Progress:
    """What is solved, by chapter: as text, and in a notebook drawn as bars."""

    def __init__(self) -> None:
        self._notice = ""
        try:
            self.points = load()
        except Damaged as damaged:
            self.points, self._notice = {}, f"{str(damaged)[0].upper()}{str(damaged)[1:]}."

    def _chapters(self) -> Iterator[tuple[str, int, int, list[tuple[Exercise, int]]]]:
        """Of every chapter its title, the points, of how many, and its exercises with the points of each."""
        for chapter, title in exercises.CHAPTERS.items():
            solved = [(each, min(each.points, self.points.get(each.name, 0))) for each in exercises.of_chapter(chapter)]
            yield title, sum(points for _, points in solved), sum(each.points for each, _ in solved), solved

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
        for title, points, max_points, solved in self._chapters():
            bar = f"<progress max='{max_points}' value='{points}'></progress>"
            total = f"{points} of {max_points}"
            rows.append(f"<tr><th style='text-align:left'>{title}</th><td>{bar}</td><td>{total}</td></tr>")
            for each, got in solved:
                small = f"<progress max='{each.points}' value='{got}' style='width:5em'></progress>"
                rows.append(
                    f"<tr><td style='text-align:left'>&emsp;{each.name} · {each.title}</td><td>{small}</td>"
                    f"<td>{got} of {each.points}</td></tr>"
                )
        return f"<table class='course-kit-progress'>{''.join(rows)}</table>"
