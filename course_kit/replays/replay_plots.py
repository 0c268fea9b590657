"""Two versions of a node on the same bag, in one picture: both paths, and how far they are apart."""

from __future__ import annotations

from itertools import cycle
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes

from course_kit.figures import COLOURS, FAINT, Plot, legend, style
from course_kit.recordings import plots
from course_kit.recordings.topic_recording import TopicRecording
from course_kit.recordings.tracks import READERS, track
from course_kit.replays.replayed import Comparison, numbered
from course_kit.series.field_paths import FieldPath, numeric_fields, reader

MOST = 4  # fields of one topic
FIRST: dict[str, Any] = {"linewidth": 3.4, "alpha": 0.55}
SECOND: dict[str, Any] = {"linewidth": 1.5}


def plot_comparison(compared: Comparison, title: str | None = None) -> Plot:
    """What both versions published: the paths of topics with a pose, the fields of others, and their differences.

    Takes what compare() returned. Raises ValueError if no topic has messages of both.
    """
    if not isinstance(compared, Comparison):
        raise TypeError(f"plot_comparison() draws what compare() returns, not {type(compared).__name__}")
    both = [topic for topic, counts in compared.counts.items() if all(counts)]
    if not both:
        raise ValueError("there is no topic on which both versions published: nothing to plot")
    names = numbered(compared.first.name, compared.second.name)
    rows = [row for topic in both for row in _rows(compared, topic)]
    heights = [4.2 if row is _path_row else 2.1 for row, *_ in rows]
    plot = Plot(10.4, 0.9 + sum(heights), title or f"{names[0]} and {names[1]}")
    grid = plot.subplots(len(rows), 2, squeeze=False, height_ratios=heights, width_ratios=(1.0, 1.0))
    for (draw, *what), (left, right) in zip(rows, grid, strict=True):
        draw(left, right, names, compared.tolerance, *what)
    for right in grid[:, 1]:
        right.set_xlabel("time since the start of the bag [s]", fontsize=10)
    legend(grid[0, 0], loc="lower left", bbox_to_anchor=(0.0, 1.08), ncols=2, borderaxespad=0.0)
    plot.align_ylabels(grid[:, 1])
    return plot


def _rows(compared: Comparison, topic: str) -> list[tuple[Any, ...]]:
    """What to draw of a topic: its path, or the fields that differ most, or its first fields if none does."""
    first, second = compared.first[topic], compared.second[topic]
    if first.type != second.type:
        return []
    if first.type in READERS:
        return [(_path_row, topic, first, second)]
    differing = [one.field for one in compared.beyond if one.topic == topic]
    known = list(numeric_fields(first.message_type))
    chosen = [field for field in differing if field in known] or [f for f in known if not f.startswith("header.")]
    return [(_field_row, topic, first, second, field) for field in chosen[:MOST]]


def _path_row(
    left: Axes,
    right: Axes,
    names: list[str],
    tolerance: float,
    topic: str,
    first: TopicRecording,
    second: TopicRecording,
) -> None:
    style(left, "x [m]", "y [m]")
    left.set_title(topic, fontsize=10, loc="right")
    tracks = [track(one.messages, one.type, one.times, one.stamps) for one in (first, second)]
    for one, name, colour, line in zip(tracks, names, COLOURS, (FIRST, SECOND), strict=False):
        jumps = one.jumps
        left.plot(plots.broken(one.x, jumps), plots.broken(one.y, jumps), color=colour, label=name, **line)
    left.plot(tracks[0].x[:1], tracks[0].y[:1], **plots.START, markeredgecolor=FAINT)
    for one, colour in zip(tracks, COLOURS, strict=False):
        left.plot(one.x[-1:], one.y[-1:], **plots.END, markerfacecolor=colour)
    left.set_aspect("equal", adjustable="datalim")
    count = min(len(first), len(second))
    apart = np.hypot(tracks[0].x[:count] - tracks[1].x[:count], tracks[0].y[:count] - tracks[1].y[:count])
    _draw_difference(right, first.times[:count], apart, tolerance, "distance [m]")


def _field_row(
    left: Axes, right: Axes, names: list[str], tolerance: float, topic: str, first: TopicRecording,
    second: TopicRecording, field: str,
) -> None:  # fmt: skip
    style(left, "time since the start of the bag [s]", title="")
    left.set_title(f"{topic}.{field}", fontsize=10, loc="right")
    read = reader(first.message_type, FieldPath(topic, field))
    values = [np.array([read(message) for message in one.messages], np.float64) for one in (first, second)]
    for one, value, name, colour, line in zip(
        (first, second), values, names, cycle(COLOURS), (FIRST, SECOND), strict=False
    ):
        left.plot(one.times, value, color=colour, label=name, **line)
    count = min(len(first), len(second))
    _draw_difference(right, first.times[:count], np.abs(values[0][:count] - values[1][:count]), tolerance, "difference")


def _draw_difference(
    axes: Axes, times: npt.NDArray[np.float64], apart: npt.NDArray[np.float64], tolerance: float, ylabel: str
) -> None:
    style(axes, ylabel=ylabel)
    axes.plot(times, apart, color=COLOURS[6], linewidth=1.4)
    largest = float(np.nanmax(apart, initial=0.0))
    axes.set_ylim(0, max(largest, tolerance, 1e-12) * 1.25)
    # A tolerance far above or below the line would press one of them onto an axis: it is named then, not drawn.
    if tolerance and 0.02 * largest < tolerance < 50 * largest:
        axes.axhline(tolerance, color=COLOURS[1], linewidth=1.2, linestyle="--", label=f"tolerance {tolerance:g}")
        axes.set_ylim(0, max(largest, tolerance) * 1.25)
        legend(axes, loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2)
    else:
        axes.set_title(f"largest {largest:.3g}, tolerance {tolerance:g}", fontsize=9, loc="right", color=FAINT)
