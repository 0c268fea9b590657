"""Numbers of topics over time as a picture."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from course_kit.base.alternative_text import span
from course_kit.base.arguments import SPAN, TEXT, takes
from course_kit.base.figures import ABOVE, COLOURS, FAINT, Plot, legend, style, widen
from course_kit.lab.series.value_series import Series, Source, Values, values

DOTS = 60  # with fewer messages each is drawn as a dot too


@takes(seconds=SPAN, title=TEXT | None)
def plot_values(
    *what: Values | str,
    source: Source | None = None,
    seconds: float = 2.0,
    together: bool = False,
    title: str | None = None,
) -> Plot:
    """Numbers over time, one row a path, or all in one: what PlotJuggler shows.

    Takes what values() returned, or paths and the `source` and `seconds` of values(). Raises ValueError if no message
    came.
    """
    drawn = _series(what, source, seconds)
    if not any(len(one) for one in drawn):
        raise ValueError(f"no message came for {', '.join(one.path for one in drawn)}. Was its publisher running?")
    row_count = 1 if together else len(drawn)
    plot = Plot(10.4, 1.1 + (3.6 if row_count == 1 else 1.75 * row_count), title)
    rows = plot.subplots(row_count, 1, squeeze=False, sharex=True)[:, 0]
    start_ns = min(one.start_ns for one in drawn)
    for number, one in enumerate(drawn):
        draw_series(rows[0 if together else number], one, COLOURS[number % len(COLOURS)], start_ns)
    for number, axes in enumerate(rows):
        is_last = number == row_count - 1
        style(axes, "time since the start [s]" if is_last else "", title="" if together else drawn[number].path)
        widen(axes)
        if together:
            legend(axes, **ABOVE)
    plot.description = in_words(drawn)
    return plot


def in_words(drawn: Iterable[Series]) -> str:
    """What a picture of series shows: of each how many messages came, in which time, first, last and extreme values."""
    return " ".join(_in_words(one) for one in drawn)


def _in_words(series: Series) -> str:
    if not np.isfinite(series.values).any():
        return f"{series.path}: no number came."
    first, last = series.times[[0, -1]]
    return (
        f"{series.path}: {len(series):,} message{'s' if len(series) != 1 else ''} from {first:.1f} s to {last:.1f} s, "
        f"{span(series.values)}, at first {series.values[0]:.4g}, at last {series.values[-1]:.4g}."
    )


def _series(what: tuple[Values | str, ...], source: Source | None, seconds: float) -> list[Series]:
    paths = [one for one in what if isinstance(one, str)]
    for one in what:
        if not isinstance(one, Values | str):
            raise TypeError(f"plot_values() draws paths and what values() returned, not {type(one).__name__}")
    read = [one for one in what if isinstance(one, Values)]
    if paths:
        read.append(values(*paths, source=source, seconds=seconds))
    drawn = [series for one in read for series in one.values()]
    if not drawn:
        raise TypeError("give paths of numbers, such as '/turtle1/pose.x', or what values() returned")
    return drawn


def draw_series(axes: Axes, series: Series, colour: str, start_ns: int) -> None:
    """One series as a line over the seconds since `start_ns`; a missing number leaves a gap."""
    seconds = (series.receive_ns - start_ns) * 1e-9
    dots: dict[str, Any] = {"marker": "o", "markersize": 3.5} if len(series) <= DOTS else {}
    axes.plot(seconds, series.values, color=colour, linewidth=1.6, label=series.path, **dots)
    if not np.isfinite(series.values).any():
        axes.text(0.5, 0.5, "no number came", color=FAINT, transform=axes.transAxes, ha="center", va="center")
