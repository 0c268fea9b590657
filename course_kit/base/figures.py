"""The look of the course's figures: a ground, colours and axes that read well in light and in dark notebooks."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from course_kit.base import alternative_text

# Colours of lines: they stay apart for colour-blind readers, and from both grounds by WCAG's 3:1. The first three are
# of Okabe and Ito, whose others are too pale for lines; those two fill what has an outline, and take ink.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#4080ff", "#998c4c", "#3a94a6", "#000000")
AMBER, SKY = "#E69F00", "#56B4E9"
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
        self.description = ""  # the picture in words, drawn from the same data: its alternative text
        if title:
            self.suptitle(title, color=INK, fontsize=12, fontweight="bold")

    def __repr__(self) -> str:
        """Its alternative text, which begins with the title."""
        title = self.get_suptitle()
        if self.description and title and title not in self.description:
            return f"{title}. {self.description}"
        return self.description or alternative_text.of_figure(self)

    def _repr_png_(self) -> tuple[bytes, dict[str, Any]]:
        picture = io.BytesIO()
        self.savefig(picture, format="png", dpi=PICTURE_DPI)
        width, height = self.get_size_inches() * SCREEN_DPI
        return picture.getvalue(), {"width": round(width), "height": round(height), "alt": repr(self)}


def luminance(colour: str) -> float:
    """Relative luminance as WCAG 2 defines it: 0 is black, 1 is white."""
    linear = [c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in to_rgb(colour)]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    """The contrast of two colours as WCAG 2 defines it: from 1 to 21; text needs 4.5, lines need 3."""
    dark, light = sorted((luminance(one), luminance(other)))
    return (light + 0.05) / (dark + 0.05)


def as_ink(colour: str) -> str:
    """A colour, darkened until text of that colour can be read on the ground of a figure."""
    red, green, blue = to_rgb(colour)
    shades = (to_hex((red * share, green * share, blue * share)) for share in np.linspace(1.0, 0.0, 21))
    return next(shade for shade in shades if contrast(shade, PAPER) >= 4.5)


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
