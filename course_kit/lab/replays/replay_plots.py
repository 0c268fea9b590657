"""Two versions of a node on the same bag, in one picture: both paths, and how far they are apart."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from course_kit.base.arguments import TEXT, takes
from course_kit.base.figures import ABOVE, COLOURS, FAINT, Plot, legend, style
from course_kit.base.text import numbered
from course_kit.lab.recordings import plots
from course_kit.lab.recordings.topic_recording import TopicRecording
from course_kit.lab.recordings.tracks import READERS, Float64s, track
from course_kit.lab.replays.replayed import Comparison
from course_kit.lab.series.field_paths import FieldPath, numeric_fields, reader

MOST = 4  # fields of one topic
# Of the first and the second version.
LINES: tuple[dict[str, Any], dict[str, Any]] = ({"linewidth": 3.4, "alpha": 0.55}, {"linewidth": 1.5})


@takes(title=TEXT | None)
def plot_comparison(compared: Comparison, title: str | None = None) -> Plot:
    """What both versions published: the paths of topics with a pose, the fields of others, and their differences.

    Takes what compare() returned. Raises ValueError if no topic has messages of both.
    """
    if not isinstance(compared, Comparison):
        raise TypeError(f"plot_comparison() draws what compare() returns, not {type(compared).__name__}")
    if not compared.both:
        raise ValueError("there is no topic on which both versions published: nothing to plot")
    names = numbered([compared.first.name, compared.second.name])
    rows = [(topic, field) for topic in compared.both for field in _fields(compared, topic)]
    heights = [2.1 if field else 4.2 for _, field in rows]
    plot = Plot(10.4, 0.9 + sum(heights), title or f"{names[0]} and {names[1]}")
    told = [f"{names[0]} and {names[1]}, tolerance {compared.tolerance:g}."]
    grid = plot.subplots(len(rows), 2, squeeze=False, height_ratios=heights, width_ratios=(1.0, 1.0))
    for (topic, field), (left, right) in zip(rows, grid, strict=True):
        first, second = compared.first[topic], compared.second[topic]
        apart = _draw_field(left, names, first, second, field) if field else _draw_paths(left, names, first, second)
        left.set_title(f"{topic}.{field}" if field else topic, fontsize=10, loc="right")
        times = first.times[: len(apart)]
        _draw_difference(right, times, apart, compared.tolerance, "difference" if field else "distance [m]")
        told.append(_in_words(f"{topic}.{field}" if field else f"The paths of {topic}", times, apart))
    for right in grid[:, 1]:
        right.set_xlabel("time since the start of the bag [s]", fontsize=10)
    legend(grid[0, 0], loc="lower left", bbox_to_anchor=(0.0, 1.08), ncols=2, borderaxespad=0.0)
    plot.align_ylabels(grid[:, 1])
    plot.description = " ".join(told)
    return plot


def _in_words(what: str, times: Float64s, apart: Float64s) -> str:
    if not np.isfinite(apart).any():
        return f"{what}: no number to compare."
    largest = int(np.nanargmax(apart))
    ends = f"at first {apart[0]:.3g}, at last {apart[-1]:.3g}"
    return f"{what}: apart by {apart[largest]:.3g} at most, {times[largest]:.2f} s after the start, {ends}."


def _fields(compared: Comparison, topic: str) -> list[str]:
    """What to draw of a topic: the fields that differ most, or its first ones if none does; '' for its path."""
    first, second = compared.first[topic], compared.second[topic]
    if first.type != second.type:
        return []
    if first.type in READERS:
        return [""]
    differing = [one.field for one in compared.beyond if one.topic == topic]
    known = list(numeric_fields(first.message_type))
    chosen = [field for field in differing if field in known] or [f for f in known if not f.startswith("header.")]
    return chosen[:MOST]


def _draw_paths(axes: Axes, names: list[str], first: TopicRecording, second: TopicRecording) -> Float64s:
    """Both paths; how far they are apart at each message."""
    style(axes, "x [m]", "y [m]")
    tracks = [track(one.messages, one.type, one.times, one.stamps) for one in (first, second)]
    for one, name, colour, line in zip(tracks, names, COLOURS, LINES, strict=False):
        axes.plot(plots.broken(one.x, one.jumps), plots.broken(one.y, one.jumps), color=colour, label=name, **line)
    axes.plot(tracks[0].x[:1], tracks[0].y[:1], **plots.START, markeredgecolor=FAINT)
    for one, colour in zip(tracks, COLOURS, strict=False):
        axes.plot(one.x[-1:], one.y[-1:], **plots.END, markerfacecolor=colour)
    axes.set_aspect("equal", adjustable="datalim")
    count = min(len(first), len(second))
    a, b = tracks
    return np.asarray(np.hypot(a.x[:count] - b.x[:count], a.y[:count] - b.y[:count]), np.float64)


def _draw_field(axes: Axes, names: list[str], first: TopicRecording, second: TopicRecording, field: str) -> Float64s:
    """A field of both over time; how far they are apart at each message."""
    style(axes, "time since the start of the bag [s]")
    read = reader(first.message_type, FieldPath(first.topic, field))
    values = [np.array([read(message) for message in one.messages], np.float64) for one in (first, second)]
    for one, value, name, colour, line in zip((first, second), values, names, COLOURS, LINES, strict=False):
        axes.plot(one.times, value, color=colour, label=name, **line)
    count = min(len(first), len(second))
    return np.abs(values[0][:count] - values[1][:count])


def _draw_difference(axes: Axes, times: Float64s, apart: Float64s, tolerance: float, ylabel: str) -> None:
    style(axes, ylabel=ylabel)
    axes.plot(times, apart, color=COLOURS[6], linewidth=1.4)
    largest = float(np.nanmax(apart, initial=0.0))
    axes.set_ylim(0, max(largest, tolerance, 1e-12) * 1.25)
    # A tolerance far above or below the line would press one of them onto an axis: it is named then, not drawn.
    if tolerance and 0.02 * largest < tolerance < 50 * largest:
        axes.axhline(tolerance, color=COLOURS[1], linewidth=1.2, linestyle="--", label=f"tolerance {tolerance:g}")
        axes.set_ylim(0, max(largest, tolerance) * 1.25)
        legend(axes, **ABOVE)
    else:
        axes.set_title(f"largest {largest:.3g}, tolerance {tolerance:g}", fontsize=9, loc="right", color=FAINT)
