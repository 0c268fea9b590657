"""Recordings as pictures: where a robot went, and how regularly messages came."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from course_kit.base.alternative_text import span
from course_kit.base.arguments import PLACES, TEXT, takes
from course_kit.base.figures import ABOVE, COLOURS, FAINT, INK, PANEL, Plot, legend, style, widen
from course_kit.base.text import numbered
from course_kit.lab.recordings.rate_statistics import Int64s, rate_over_time
from course_kit.lab.recordings.rates import RateMeter
from course_kit.lab.recordings.recording import Recording
from course_kit.lab.recordings.topic_recording import TopicRecording
from course_kit.lab.recordings.tracks import READERS, Track, track
from course_kit.robots.turtlesim.field import EXTENT

TURTLE = "turtlesim/msg/Pose"
ARROWS = 14  # along a path
START: dict[str, Any] = {"marker": "o", "markersize": 9, "markerfacecolor": PANEL, "markeredgewidth": 2, "zorder": 4}
END: dict[str, Any] = {"marker": "s", "markersize": 8, "markeredgecolor": PANEL, "zorder": 5}
GOAL: dict[str, Any] = {"marker": "+", "markersize": 16, "markeredgewidth": 2, "color": INK, "zorder": 6}


@takes(title=TEXT | None, goals=PLACES)
def plot_pose(
    recorded: Recording | TopicRecording, title: str | None = None, goals: Sequence[tuple[float, float]] = ()
) -> Plot:
    """The path of a robot, and its heading and velocities over time; of several robots if several were recorded.

    A cross marks each of the `goals`, which are places (x, y) in metres. Takes recordings of turtlesim/msg/Pose,
    geometry_msgs/msg/PoseStamped and nav_msgs/msg/Odometry. Raises ValueError for other types and for an empty
    recording.
    """
    with_pose = _with_pose(recorded)
    tracks = {one.topic: track(one.messages, one.type, one.times, one.stamps) for one in with_pose}
    plot = Plot(10.4, 5.2, title or ", ".join(tracks))
    left, right = plot.subfigures(1, 2, width_ratios=(1.05, 1.0))
    field = style(left.subplots(), "x [m]", "y [m]")
    heading, linear, angular = right.subplots(3, 1, sharex=True)
    style(heading, ylabel="heading [rad]")
    style(linear, ylabel="linear velocity\n[m/s]")
    style(angular, "time since the start of the recording [s]", "angular velocity\n[rad/s]")
    for colour, (topic, of_topic) in zip(COLOURS, tracks.items(), strict=False):
        _draw_path(field, of_topic, colour, topic if len(tracks) > 1 else "path")
        turned_over = np.abs(np.diff(of_topic.heading)) > np.pi
        heading.plot(broken(of_topic.times, turned_over), broken(of_topic.heading, turned_over), color=colour)
        linear.plot(of_topic.times, of_topic.linear, color=colour)
        angular.plot(of_topic.times, of_topic.angular, color=colour)
    field.plot([], [], **START, markeredgecolor=FAINT, linestyle="", label="start")
    field.plot([], [], **END, markerfacecolor=FAINT, linestyle="", label="end")
    if len(goals):
        field.plot(*np.transpose(np.asarray(goals, np.float64)), **GOAL, linestyle="", label="goal")
    heading.set_ylim(-np.pi * 1.1, np.pi * 1.1)
    heading.set_yticks([-np.pi, -np.pi / 2, 0, np.pi / 2, np.pi], ["\u2212π", "\u2212π/2", "0", "π/2", "π"])
    for axes in (linear, angular):
        widen(axes, 0.5)
    right.align_ylabels()
    if any(one.type == TURTLE for one in with_pose):
        _draw_turtle_field(field)
    else:
        field.set_aspect("equal", adjustable="datalim")
    legend(field, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3)
    places = ", ".join(f"({x:.2f}, {y:.2f}) m" for x, y in goals)
    told = [_path_in_words(topic, one) for topic, one in tracks.items()] + ([f"Goals: {places}."] if places else [])
    plot.description = " ".join(told)
    return plot


def _path_in_words(topic: str, of_topic: Track) -> str:
    x, y, jumps = of_topic.x, of_topic.y, of_topic.jumps
    length = float(np.hypot(np.diff(x), np.diff(y))[~jumps].sum())
    jumped = int(jumps.sum())
    words = [
        f"Path of {topic}: {of_topic.times[-1] - of_topic.times[0]:.1f} s",
        f"from ({x[0]:.2f}, {y[0]:.2f}) m to ({x[-1]:.2f}, {y[-1]:.2f}) m",
        f"{length:.2f} m long" + (f" with {jumped} jump{'s' if jumped > 1 else ''}" if jumped else ""),
        f"x {span(x, 'm')}, y {span(y, 'm')}",
        f"heading {of_topic.heading[0]:.2f} rad at the start and {of_topic.heading[-1]:.2f} rad at the end",
        f"linear velocity {span(of_topic.linear, 'm/s')}, angular velocity {span(of_topic.angular, 'rad/s')}",
    ]
    return "; ".join(words) + "."


def _with_pose(recorded: Recording | TopicRecording) -> list[TopicRecording]:
    """The recorded topics that carry a pose."""
    if not isinstance(recorded, Recording | TopicRecording):
        raise TypeError(f"plot_pose() draws what record() returns, not {type(recorded).__name__}")
    there = [recorded] if isinstance(recorded, TopicRecording) else list(recorded)
    with_pose = [one for one in there if one.type in READERS]
    if not with_pose:
        types = ", ".join(f"{one.topic} is {one.type}" for one in there)
        raise ValueError(f"no pose to plot: {types}. plot_pose() draws {', '.join(READERS)}")
    filled = [one for one in with_pose if len(one)]
    if not filled:
        raise ValueError(_empty([one.topic for one in with_pose]))
    return filled


def _empty(names: list[str]) -> str:
    return f"the recording of {', '.join(names)} is empty: no message came. Was its publisher running meanwhile?"


def broken(line: npt.NDArray[Any], after: npt.NDArray[np.bool_]) -> npt.NDArray[np.float64]:
    """The line with a gap after each element marked in `after`."""
    return np.insert(np.asarray(line, np.float64), np.flatnonzero(after) + 1, np.nan)


def _draw_path(axes: Axes, of_topic: Track, colour: str, label: str) -> None:
    x, y, heading, jumps = of_topic.x, of_topic.y, of_topic.heading, of_topic.jumps
    axes.plot(broken(x, jumps), broken(y, jumps), color=colour, linewidth=1.8, label=label)
    axes.plot(x[:1], y[:1], **START, markeredgecolor=colour)
    axes.plot(x[-1:], y[-1:], **END, markerfacecolor=colour)
    way = np.concatenate([[0.0], np.cumsum(np.where(jumps, 0.0, np.hypot(np.diff(x), np.diff(y))))])
    at = np.searchsorted(way, np.linspace(0.0, way[-1], ARROWS + 2)[1:-1])
    if way[-1] < 0.05:  # it stood still
        at = np.array([len(x) - 1])
    axes.quiver(
        x[at], y[at], np.cos(heading[at]), np.sin(heading[at]),
        color=colour, pivot="mid", units="inches", scale=5.5, scale_units="inches",
        width=0.02, headwidth=7, headlength=7, headaxislength=6, zorder=3,
    )  # fmt: skip


def _draw_turtle_field(axes: Axes) -> None:
    axes.add_patch(Rectangle((0, 0), EXTENT, EXTENT, facecolor="#eef4fb", edgecolor="#9db4cc", linewidth=1.2, zorder=0))
    for low, high, limit in ((*axes.get_xlim(), axes.set_xlim), (*axes.get_ylim(), axes.set_ylim)):
        limit(min(low, -0.4), max(high, EXTENT + 0.4))
    axes.set_xticks(range(0, 12, 2))
    axes.set_yticks(range(0, 12, 2))
    axes.set_aspect("equal")


@takes(title=TEXT | None)
def plot_rates(*measured: Recording | TopicRecording | RateMeter, title: str | None = None) -> Plot:
    """The rate of each topic over time, and how its periods are distributed, one row a topic.

    Takes recordings and rate meters, one or more. Raises ValueError if no topic has two messages.
    """
    arrivals = arrivals_of(measured)
    silent = [name for name, receive_ns in arrivals.items() if len(receive_ns) < 2]
    drawn = {name: receive_ns for name, receive_ns in arrivals.items() if name not in silent}
    if not drawn:
        raise ValueError(f"{_empty(silent)} A rate needs two messages." if silent else "nothing was given to plot")
    plot = Plot(10.4, 0.9 + 2.3 * len(drawn), title or "Rates and periods")
    rows = plot.subplots(len(drawn), 2, squeeze=False, width_ratios=(1.25, 1.0))
    for row, (name, receive_ns) in enumerate(drawn.items()):
        colour = COLOURS[row % len(COLOURS)]
        is_last = row == len(drawn) - 1
        left = style(rows[row, 0], "time since the first message [s]" if is_last else "", "rate [Hz]", name)
        _draw_rate(left, receive_ns, colour)
        right = style(rows[row, 1], "period between messages [ms]" if is_last else "", "messages (log)")
        _draw_periods(right, receive_ns, colour)
    if silent:
        plot.supxlabel(f"fewer than two messages: {', '.join(silent)}", color=FAINT, fontsize=9)
    told = [_rate_in_words(name, receive_ns) for name, receive_ns in drawn.items()]
    plot.description = " ".join(told + [f"{name}: fewer than two messages." for name in silent])
    return plot


def _rate_in_words(name: str, receive_ns: Int64s) -> str:
    edges, hertz = rate_over_time(receive_ns)
    median, p99, longest = _percentiles(np.diff(receive_ns) * 1e-6)
    return (
        f"{name}: {len(receive_ns):,} messages in {edges[-1]:.1f} s, mean {(len(receive_ns) - 1) / edges[-1]:,.4g} Hz, "
        f"over time {span(hertz, 'Hz')}; periods: median {median:,.3g} ms, 99 % within {p99:,.3g} ms, "
        f"longest {longest:,.3g} ms."
    )


def _percentiles(periods: npt.NDArray[Any]) -> tuple[float, float, float]:
    """The median, the 99th percentile and the longest."""
    median, p99, longest = (float(value) for value in np.percentile(periods, (50, 99, 100)))
    return median, p99, longest


def arrivals_of(measured: tuple[Recording | TopicRecording | RateMeter, ...]) -> dict[str, Int64s]:
    """When the messages of each topic came, in that order; a topic that was measured twice counts its measurements."""
    found: list[tuple[str, Int64s]] = []
    for one in measured:
        if isinstance(one, TopicRecording):
            found.append((one.topic, one.receive_ns))
        elif isinstance(one, Recording):
            found += [(topic.topic, topic.receive_ns) for topic in one]
        elif isinstance(one, RateMeter):
            found += [(topic, one.arrivals(topic)[0]) for topic in one.topics]
        else:
            raise TypeError(f"plot_rates() draws what record() and measure_rates() return, not {type(one).__name__}")
    names = numbered([name for name, _ in found])
    # Messages of two publishers may be taken a little out of order.
    return dict(zip(names, (np.sort(receive_ns) for _, receive_ns in found), strict=True))


def _draw_rate(axes: Axes, receive_ns: Int64s, colour: str) -> None:
    edges, hertz = rate_over_time(receive_ns)
    mean = (len(receive_ns) - 1) / edges[-1]
    axes.stairs(hertz, edges, baseline=None, color=colour, linewidth=1.6, label="rate")
    axes.axhline(mean, color=FAINT, linewidth=1.2, linestyle="--", label=f"mean {mean:,.4g} Hz")
    axes.set_ylim(0, max(hertz.max(), mean) * 1.2)
    axes.set_xlim(0, edges[-1])
    legend(axes, **ABOVE)


def _draw_periods(axes: Axes, receive_ns: Int64s, colour: str) -> None:
    periods = np.diff(receive_ns) * 1e-6
    median, p99, longest = _percentiles(periods)
    shown = max(1.1 * median, min(longest, 2.5 * p99 - 1.5 * median))
    low = min(periods.min(), 0.9 * median)
    bins = np.linspace(low, shown * 1.0001, 60)
    axes.hist(periods, list(bins), color=colour, alpha=0.85, edgecolor=PANEL, linewidth=0.3)
    axes.axvline(median, color="#000000", linewidth=1.3, label=f"median {median:,.3g} ms")
    axes.axvline(p99, color="#000000", linewidth=1.3, linestyle=":", label=f"p99 {p99:,.3g} ms")
    beyond = int((periods > bins[-1]).sum())
    if beyond:
        axes.plot([], [], " ", label=f"{beyond} longer, up to {longest:,.3g} ms")
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter("{x:,.0f}")
    axes.set_ylim(bottom=0.7)
    axes.set_xlim(bins[0], bins[-1])
    legend(axes, **ABOVE)
