"""The verdict of a check: findings, points, hints; as text, as HTML, as JSON. Pure: no ROS, no Jupyter."""

from __future__ import annotations

import html
from dataclasses import dataclass
from typing import Any

from course_kit.base import inks

NOT_BEGUN = "not begun"
LOOKED_AT = "looked at"
NOT_LOOKED_AT = "could not look"  # the checker itself failed: nothing is said about the answer
GRADED = "examined; the grader has the verdict"


IN_TIME = "comes to an end in time"  # what a check finds that does not


@dataclass(frozen=True)
class Finding:
    """One thing that was looked at."""

    text: str
    ok: bool
    hint: str = ""  # the cause, and what to look at next; only if it is not ok
    max_points: int = 0  # 0 for what must hold before the rest can be seen

    @property
    def points(self) -> int:
        """The points that this finding is worth as it came out."""
        return self.max_points if self.ok else 0

    @property
    def mark(self) -> str:
        """The sign in front of it."""
        return "✔" if self.ok else "✘"

    @property
    def claim(self) -> str:
        """The text, and the points that it has."""
        return f"{self.text} ({points_text(self.points, self.max_points)})" if self.max_points else self.text

    def __str__(self) -> str:
        hint = f"\n    {self.hint}" if self.hint and not self.ok else ""
        return f"{self.mark} {self.claim}{hint}"


@dataclass(frozen=True, repr=False)
class Verdict:
    """What a check of one exercise found."""

    exercise: str
    title: str
    max_points: int  # points that the exercise is worth
    state: str = LOOKED_AT
    findings: tuple[Finding, ...] = ()
    note: str = ""  # what to do, if nothing was looked at
    seed: int | None = None  # of what the check drew; with it the same is drawn again
    further: str = ""  # what the notebook adds: where to read on

    @property
    def points(self) -> int:
        """The points of all findings, never more than the exercise has."""
        return min(self.max_points, sum(finding.points for finding in self.findings))

    @property
    def is_full(self) -> bool:
        """True if nothing is left to do."""
        return self.state == LOOKED_AT and self.points == self.max_points and all(f.ok for f in self.findings)

    @property
    def heading(self) -> str:
        """One line: exercise, title, points or why there are none."""
        result = points_text(self.points, self.max_points) if self.state == LOOKED_AT else self.state
        return f"{self.exercise} · {self.title}: {result}"

    @property
    def _drawn(self) -> str:
        return "" if self.seed is None else f'check("{self.exercise}", seed={self.seed}) repeats what was drawn for it'

    def __repr__(self) -> str:
        note = [f"    {line}" for line in (self.note, self._drawn, self.further) if line]
        return "\n".join([self.heading, *map(str, self.findings), *note])

    def _repr_html_(self) -> str:
        """The same with colours that can be read on light and on dark ground."""
        lines = [f"<b>{html.escape(self.heading)}</b>"]
        for finding in self.findings:
            sign = f"<span style='color:{inks.GOOD if finding.ok else inks.BAD}'>{finding.mark}</span>"
            hint = "" if finding.ok else f"<div style='margin-left:2em'>{in_code(finding.hint)}</div>"
            lines.append(f"<div>{sign} {in_code(finding.claim)}</div>{hint}")
        if self.note:
            lines.append(f"<div style='margin-left:2em'>{in_code(self.note)}</div>")
        if self._drawn:
            lines.append(f"<div style='margin-left:2em;opacity:0.8'>{html.escape(self._drawn)}</div>")
        if self.further:
            lines.append(f"<div style='margin-left:2em'>{in_code(self.further)}</div>")
        return f"<div class='course-kit-check'>{''.join(lines)}</div>"

    @staticmethod
    def from_json(data: dict[str, Any]) -> Verdict:
        """The verdict that asdict() made this of. KeyError or TypeError for anything else."""
        return Verdict(**{**data, "findings": tuple(Finding(**finding) for finding in data["findings"])})


def points_text(points: int, max_points: int) -> str:
    """Points of a maximum, in words."""
    return f"{points} of {max_points} {'point' if max_points == 1 else 'points'}"


def in_code(text: str) -> str:
    """Text with `code` in it as HTML."""
    parts = html.escape(text).split("`")
    if len(parts) % 2 == 0:  # a backquote without its partner
        return html.escape(text)
    return "".join(f"<code>{part}</code>" if place % 2 else part for place, part in enumerate(parts))
