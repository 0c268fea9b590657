"""The output of `ros2 topic hz`, `bw` and `delay`. Imports no ROS."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from course_kit.lab.recordings.rate_statistics import Reading, Spread

_HEADINGS = ("topic", "rate", "min_delta", "max_delta", "std_dev", "window")


def bw_text(bytes_per_second: float, size: Spread, window: int) -> str:
    """What bw prints: bytes a second and the spread of the sizes, all in the unit that fits the first."""
    shown, divisor = "{:.2f} MB", 1_000_000
    if bytes_per_second < 1000:
        shown, divisor = "{:.0f} B", 1
    elif bytes_per_second < 1_000_000:
        shown, divisor = "{:.2f} KB", 1000
    total, mean, smallest, largest = (
        shown.format(value / divisor) for value in (bytes_per_second, size.mean, size.min, size.max)
    )
    return f"{total}/s from {window} messages\n\tMessage size mean: {mean} min: {smallest} max: {largest}"


def seconds_text(average: str, spread: Spread, window: int) -> str:
    """What hz and delay print: an average, the spread of times in seconds, how many these are."""
    return (
        f"average {average}\n"
        f"\tmin: {spread.min:.3f}s max: {spread.max:.3f}s std dev: {spread.std:.5f}s window: {window}"
    )


def hz_text(reading: Reading) -> str:
    """What hz prints of one topic."""
    return seconds_text(f"rate: {_rate(reading):.3f}", reading.period, reading.window - 1)


def hz_table(readings: Mapping[str, Reading]) -> str:
    """What hz prints of several topics: a line of each under a heading, and an empty line."""
    rows = []
    for topic, one in readings.items():
        spread = (f"{one.period.min:.3f}", f"{one.period.max:.3f}", f"{one.period.std:.5f}")
        rows.append((topic, f"{_rate(one):.3f}", *spread, str(one.window - 1)))
    columns = list(zip(_HEADINGS, *rows, strict=True))
    widths = [max(map(len, column)) for column in columns]
    lines = ["   ".join(text.center(width) for text, width in zip(_HEADINGS, widths, strict=True))]
    lines.append("=" * len(lines[0]))
    lines += ["   ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)) for row in rows]
    return "\n".join([*lines, ""])


def _rate(reading: Reading) -> float:
    """Its rate; 0 if no time has passed on its clock, as on a simulated one that stands."""
    return 0.0 if math.isnan(reading.rate) else reading.rate
