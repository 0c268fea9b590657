"""A matplotlib figure in words, from what is drawn in it: for those that nobody has described."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.category import StrCategoryFormatter
from matplotlib.collections import EventCollection
from matplotlib.container import BarContainer
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedFormatter, FuncFormatter

MOST = 12  # lines of one axes that are described


def of_figure(figure: Figure) -> str:
    """Its title, and of each axes the title, the labels, and what the lines and bars show."""
    title = figure.get_suptitle()
    parts = [_of_axes(axes) for axes in figure.axes if axes.get_visible()]
    return " ".join(part for part in (f"{title}." if title else "", *parts) if part) or "An empty figure."


def span(values: npt.ArrayLike, unit: str = "") -> str:
    """Where numbers lie: 'from 1 to 3 m', or '2 m' where all are the same."""
    there = np.asarray(values, np.float64)
    there = there[np.isfinite(there)]
    if not len(there):
        return "no number"
    there[np.abs(there) < 1e-5 * np.abs(there).max()] = 0.0  # what arithmetic leaves of a zero
    low, high = f"{there.min():.4g}", f"{there.max():.4g}"
    return f"{low if low == high else f'from {low} to {high}'} {unit}".rstrip()


def _of_axes(axes: Axes) -> str:
    titles = (axes.get_title(), axes.get_title(loc="left"), axes.get_title(loc="right"))
    words = [": ".join(title for title in titles if title) or "A plot"]
    labels = [f"{name} is {text}" for name, text in (("x", axes.get_xlabel()), ("y", axes.get_ylabel())) if text]
    if labels:
        words.append(" and ".join(labels))
    words += [f"{name} {place:.4g} is {text}" for name, place, text in _named_places(axes)]
    lines = [line for line in axes.get_lines() if np.size(line.get_xdata(orig=False))]
    words += [_of_line(line) for line in lines[:MOST]]
    if len(lines) > MOST:
        words.append(f"and {len(lines) - MOST} lines more")
    bars = [one for one in axes.containers if isinstance(one, BarContainer)]
    words += [_of_bars(one) for one in bars if len(one)]
    of_bars = {id(patch) for one in bars for patch in one}
    areas = [patch.get_window_extent() for patch in axes.patches if id(patch) not in of_bars]
    if areas:
        corners = [corner for box in areas for corner in (box.min, box.max)]
        sides = axes.transData.inverted().transform(corners)[:, 0]
        words.append(_counted(len(areas), "area") + f", x {span(sides)}")
    for some in axes.collections:
        places = some.get_positions() if isinstance(some, EventCollection) else np.asarray(some.get_offsets())[:, :1]
        words.append(_counted(len(places), "mark") + f", x {span(places)}")
    if axes.images:
        words.append("an image")
    words += [text.get_text() for text in axes.texts if text.get_text()]
    return ", ".join(words) + "."


def _named_places(axes: Axes) -> list[tuple[str, float, str]]:
    """The places on both axes that have names in place of numbers."""
    return [
        (name, float(place), tick.get_text())
        for name, axis in (("x", axes.xaxis), ("y", axes.yaxis))
        if isinstance(axis.get_major_formatter(), FixedFormatter | FuncFormatter | StrCategoryFormatter)
        for place, tick in zip(axis.get_majorticklocs(), axis.get_majorticklabels(), strict=False)
        if tick.get_text()
    ]


def _of_line(line: Line2D) -> str:
    name = str(line.get_label())
    x, y = (np.asarray(values, np.float64) for values in (line.get_xdata(orig=False), line.get_ydata(orig=False)))
    what = "a line" if name.startswith("_") else name
    return f"{what} with {_counted(len(x), 'point')}: x {span(x)}, y {span(y)}"


def _of_bars(bars: BarContainer) -> str:
    lengths = [bar.get_width() if bars.orientation == "horizontal" else bar.get_height() for bar in bars]
    return f"{_counted(len(lengths), 'bar')}, length {span(lengths)}"


def _counted(count: int, what: str) -> str:
    return f"{count} {what}{'s' if count != 1 else ''}"
