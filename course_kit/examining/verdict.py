"""What a check found: findings, points, hints; as text, as HTML, as JSON. Pure: no ROS, no Jupyter."""

from __future__ import annotations

import html
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from typing import Any

NOT_BEGUN = "not begun"
LOOKED_AT = "looked at"
NOT_LOOKED_AT = "could not look"  # the checker itself failed: nothing is said about the answer


@dataclass(frozen=True)
class Finding:
    """One thing that was looked at. `of` is what it is worth; 0 for what must hold before the rest can be seen."""

    text: str
    ok: bool
    hint: str = ""  # the cause, and what to look at next; only if it is not ok
    of: int = 0

    @property
    def points(self) -> int:
        """The points that this finding is worth as it came out."""
        return self.of if self.ok else 0


@dataclass(frozen=True)
class Verdict:
    """What a check of one exercise found."""

    exercise: str
    title: str
    of: int  # points that the exercise is worth
    state: str = LOOKED_AT
    findings: tuple[Finding, ...] = ()
    note: str = ""  # what to do, if nothing was looked at
    seconds: float = field(default=0.0, compare=False)

    @property
    def points(self) -> int:
        """The points of all findings, never more than the exercise has."""
        return min(self.of, sum(finding.points for finding in self.findings))

    @property
    def is_full(self) -> bool:
        """Whether nothing is left to do."""
        return self.state == LOOKED_AT and self.points == self.of and all(f.ok for f in self.findings)

    @property
    def hints(self) -> list[str]:
        """The hints of what did not hold."""
        return [finding.hint for finding in self.findings if not finding.ok]

    @property
    def heading(self) -> str:
        """One line: exercise, title, points or why there are none."""
        result = points_text(self.points, self.of) if self.state == LOOKED_AT else self.state
        return f"{self.exercise} · {self.title}: {result}"

    def __str__(self) -> str:
        lines = [self.heading]
        for finding in self.findings:
            lines.append(f"{mark(finding.ok)} {finding.text}{_worth(finding)}")
            if not finding.ok and finding.hint:
                lines.append(f"    {finding.hint}")
        if self.note:
            lines.append(f"    {self.note}")
        return "\n".join(lines)

    def to_html(self) -> str:
        """The same with colours that can be read on light and on dark ground."""
        lines = [f"<b>{html.escape(self.heading)}</b>"]
        for finding in self.findings:
            colour = "#2e8b57" if finding.ok else "#dc322f"
            sign = f"<span style='color:{colour}'>{mark(finding.ok)}</span>"
            hint = "" if finding.ok else f"<div style='margin-left:2em'>{in_code(finding.hint)}</div>"
            lines.append(f"<div>{sign} {in_code(finding.text + _worth(finding))}</div>{hint}")
        if self.note:
            lines.append(f"<div style='margin-left:2em'>{in_code(self.note)}</div>")
        return f"<div class='course-kit-check'>{''.join(lines)}</div>"

    def to_json(self) -> dict[str, Any]:
        """The verdict as what JSON can hold."""
        return asdict(self)

    @staticmethod
    def from_json(data: dict[str, Any]) -> Verdict:
        """The verdict that to_json() was made from. KeyError or TypeError for anything else."""
        findings: Iterable[dict[str, Any]] = data["findings"]
        return Verdict(**{**data, "findings": tuple(Finding(**one) for one in findings)})


def mark(ok: bool) -> str:
    """The sign in front of a finding."""
    return "✔" if ok else "✘"


def points_text(points: int, of: int) -> str:
    """Points of a maximum, in words."""
    return f"{points} of {of} {'point' if of == 1 else 'points'}"


def _worth(finding: Finding) -> str:
    return f" ({points_text(finding.points, finding.of)})" if finding.of else ""


def in_code(text: str) -> str:
    """Text with `code` in it as HTML."""
    parts = html.escape(text).split("`")
    if len(parts) % 2 == 0:  # a backquote without its partner
        return html.escape(text)
    return "".join(f"<code>{part}</code>" if place % 2 else part for place, part in enumerate(parts))
