"""What the benchmark prints: one row for each thing measured, plain rclpy beside the course."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

HEADINGS = ("what", "unit", "plain / stock", "course", "ratio", "aim", "met?")


@dataclass(frozen=True)
class Row:
    """One measured thing; a column that does not apply is None, and so is `met` where nothing is aimed at."""

    what: str
    unit: str
    plain: float | None = None
    course: float | None = None
    aim: str = ""
    met: bool | None = None

    @property
    def ratio(self) -> float | None:
        """Course divided by plain."""
        return self.course / self.plain if self.plain and self.course is not None else None

    def cells(self) -> tuple[str, ...]:
        met = "" if self.met is None else "yes" if self.met else "NO"
        return (self.what, self.unit, *map(number, (self.plain, self.course, self.ratio)), self.aim, met)


def lower(what: str, unit: str, plain: float, course: float, ratio: float = 1.0) -> Row:
    """A row whose aim is that the course needs at most `ratio` times what plain rclpy needs."""
    return Row(what, unit, plain, course, f"ratio ≤ {ratio:g}", course <= ratio * plain)


def higher(what: str, unit: str, plain: float, course: float, ratio: float = 1.0) -> Row:
    """A row whose aim is that the course reaches at least `ratio` times what plain rclpy reaches."""
    return Row(what, unit, plain, course, f"ratio ≥ {ratio:g}", course >= ratio * plain)


def at_most(what: str, unit: str, course: float, limit: float, plain: float | None = None) -> Row:
    """A row whose aim is a limit that the course stays below."""
    return Row(what, unit, plain, course, f"≤ {number(limit)}", course <= limit)


def at_least(what: str, unit: str, course: float, limit: float, plain: float | None = None) -> Row:
    """A row whose aim is a value that the course reaches."""
    return Row(what, unit, plain, course, f"≥ {number(limit)}", course >= limit)


def number(value: float | None) -> str:
    """Three digits of a number, and no more zeros than needed."""
    if value is None:
        return ""
    if value == int(value) or abs(value) >= 100:
        return f"{value:,.0f}"
    return f"{value:.3g}"


def formatted(rows: Iterable[Row]) -> str:
    """The table as text: a column for each heading, the numbers flush right."""
    lines = [HEADINGS, *(row.cells() for row in rows)]
    widths = [max(len(line[column]) for line in lines) for column in range(len(HEADINGS))]
    right = {2, 3, 4}
    texts = [
        " | ".join(
            cell.rjust(width) if column in right else cell.ljust(width)
            for column, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    ]
    return "\n".join([texts[0], "-+-".join("-" * width for width in widths), *texts[1:]])
