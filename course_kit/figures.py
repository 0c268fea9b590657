"""The look of the course's figures: a ground, colours and axes that read well in light and in dark notebooks."""

from __future__ import annotations

import io
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

# Colours that stay apart for colour-blind readers (Okabe and Ito), those with most contrast first.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
PAPER, PANEL, INK, FAINT, LINES = "#f6f6f3", "#ffffff", "#1b1b1b", "#565656", "#deded9"
# Where a legend stands above its axes.
ABOVE: dict[str, Any] = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0), "ncols": 3, "borderaxespad": 0.2}
SCREEN_DPI, PICTURE_DPI = 88, 176  # shown at the first, drawn at the second: sharp on any screen


class Plot(Figure):
    """A matplotlib Figure that shows itself: a cell that ends in one shows it once, with or without pyplot."""

    def __init__(self, width: float, height: float, title: str | None = None) -> None:
        """Width and height in inches."""
        layout = ConstrainedLayoutEngine(w_pad=0.1, h_pad=0.08)
        super().__init__(figsize=(width, height), dpi=SCREEN_DPI, facecolor=PAPER, layout=layout)
        if title:
            self.suptitle(title, color=INK, fontsize=12, fontweight="bold")

    def _repr_png_(self) -> tuple[bytes, dict[str, int]]:
        picture = io.BytesIO()
        self.savefig(picture, format="png", dpi=PICTURE_DPI)
        width, height = self.get_size_inches() * SCREEN_DPI
        return picture.getvalue(), {"width": round(width), "height": round(height)}


def style(axes: Axes, xlabel: str = "", ylabel: str = "", title: str = "") -> Axes:
    """Give axes the course's look and their labels; return them."""
    axes.set_facecolor(PANEL)
    axes.grid(True, color=LINES, linewidth=0.7)
    axes.set_axisbelow(True)
    axes.tick_params(colors=FAINT, labelcolor=INK, labelsize=9, length=3)
    axes.spines[["top", "right"]].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_color(FAINT)
    axes.set_xlabel(xlabel, color=INK, fontsize=10)
    axes.set_ylabel(ylabel, color=INK, fontsize=10)
    axes.set_title(title, color=INK, fontsize=10, loc="left")
    return axes


def widen(axes: Axes, span: float | None = None) -> None:
    """Widen the y axis to this at least, so that the last digit of a constant does not look like an event.

    Without a span to what is little for numbers of that size.
    """
    low, high = axes.get_ylim()
    if span is None:
        span = 2e-3 * max(abs(low), abs(high), 1e-9)
    if high - low < span:
        middle = (low + high) / 2
        axes.set_ylim(middle - span / 2, middle + span / 2)


def legend(axes: Axes, **where: Any) -> None:
    """A legend of the given `handles`, or for axes that have labelled lines."""
    if "handles" in where or axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize=8.5, frameon=True, facecolor=PANEL, edgecolor=LINES, labelcolor=INK, **where)
