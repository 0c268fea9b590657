"""A class drawn: how its points are spread, which exercises are hard; as SVG that a page holds. Pure: no ROS."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence

import matplotlib
from markupsafe import Markup, escape
from matplotlib.ticker import MaxNLocator

from course_kit.base.figures import COLOURS, FAINT, INK, LINES, Plot, style

STEP = 10  # percent in a bar of the spread
# Text stays text; and the same picture always has the same names in it.
SETTINGS = {"svg.fonttype": "none", "svg.hashsalt": "course_kit"}
# No date and no program: the same results make the same page.
NOTHING = {"Date": None, "Creator": None, "Format": None, "Type": None}


def spread(percents: Sequence[float]) -> Markup:
    """How many students have how many percent of the points."""
    plot = Plot(7.0, 2.6)
    axes = style(plot.subplots(), "percent of the points", "students")
    counts = [0] * (100 // STEP)
    for percent in percents:
        counts[min(int(percent // STEP), len(counts) - 1)] += 1
    bars = axes.bar([STEP * place for place in range(len(counts))], counts, 0.92 * STEP, align="edge", color=COLOURS[0])
    axes.bar_label(bars, [str(count) if count else "" for count in counts], color=INK, fontsize=9)
    axes.set_xticks(range(0, 101, STEP))
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    axes.margins(y=0.15)
    axes.grid(False, axis="x")
    bins = [f"{STEP * place} to {STEP * (place + 1)} %: {count}" for place, count in enumerate(counts) if count]
    return _svg(plot, "spread", f"How many students have how many percent of the points. {', '.join(bins)}.")


def shares(exercises: Sequence[tuple[str, float]]) -> Markup:
    """What share of an exercise's points the class has, in percent; drawn from the top in the order given."""
    plot = Plot(7.0, 0.7 + 0.26 * len(exercises))
    axes = style(plot.subplots(), "mean percent of the exercise's points")
    names, percents = [name for name, _ in exercises], [percent for _, percent in exercises]
    bars = axes.barh(names, percents, 0.7, color=COLOURS[0])
    axes.bar_label(bars, [f"{percent:.0f}" for percent in percents], padding=3, color=INK, fontsize=9)
    axes.set_xlim(0, 108)  # the number beside a full bar
    axes.set_xticks(range(0, 101, 20))
    axes.set_ylim(len(exercises) - 0.4, -0.6)
    axes.grid(False, axis="y")
    means = ", ".join(f"{name}: {percent:.0f} %" for name, percent in exercises)
    return _svg(plot, "shares", f"Mean percent of the points, by exercise, the hardest first. {means}.")


def _svg(plot: Plot, name: str, told: str) -> Markup:
    """A plot for the middle of a page: its ink is the page's own, its names are no others' on the page."""
    text = io.StringIO()
    with matplotlib.rc_context(SETTINGS):
        plot.savefig(text, format="svg", transparent=True, metadata=NOTHING)
    svg = text.getvalue()
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r'(\bid="|url\(#|href="#)', rf"\g<1>{name}-", svg)
    for colour, drawn in ((INK, "currentColor"), (FAINT, "currentColor"), (LINES, "#80808060")):
        svg = svg.replace(colour, drawn)
    return Markup(svg.replace("<svg ", f'<svg role="img" aria-label="{escape(told)}" ', 1))
