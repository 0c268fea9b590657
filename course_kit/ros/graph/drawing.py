"""The parts of pictures of graphs: cards, lines between them, a heading, a legend."""

from __future__ import annotations

import itertools
from functools import lru_cache
from typing import Any

from matplotlib.axes import Axes
from matplotlib.font_manager import FontProperties, findfont, get_font
from matplotlib.ft2font import LoadFlags
from matplotlib.lines import Line2D
from matplotlib.patches import FancyBboxPatch, PathPatch, Polygon, Rectangle
from matplotlib.path import Path

from course_kit.base.figures import COLOURS, FAINT, INK, PANEL, Plot
from course_kit.ros.graph.cards import PAD_X, Card, Wire

FONT = "DejaVu Sans"  # it comes with matplotlib, so widths are the same everywhere
MARGIN, HEAD, FOOT = 0.22, 0.42, 0.3  # inches
NARROWEST = 6.0
SWATCH = 0.34  # inches of the legend's lines
TROUBLE, TROUBLE_INK = COLOURS[1], "#a33c00"
WIRE = "#6f7780"
# Face and edge of what can stand in a graph.
LOOKS = {
    "node": ("#dcebf7", COLOURS[0]),
    "topic": (PANEL, "#8a8a84"),
    "service": ("#dff3ea", COLOURS[2]),
    "action": ("#f9e8f1", "#c0609b"),
}
INKS = {"name": INK, "detail": FAINT, "trouble": TROUBLE_INK}


Legend = list[tuple[str, dict[str, Any] | str]]  # names; how their lines look, or what stands there


def sheet(heading: str, legend: Legend, width: float, height: float) -> tuple[Plot, Axes]:
    """A figure with room for what is `width` by `height` inches, whose axes begin at its upper left corner.

    y runs down, both axes are in inches. The heading is drawn; for the legend there is room.
    """
    of_legend = sum(SWATCH + 0.3 + text_width(name, 8) for name, _ in legend)
    wide = max(width, text_width(heading, 12, True), of_legend, NARROWEST - 2 * MARGIN)
    plot = Plot(wide + 2 * MARGIN, height + HEAD + FOOT + 2 * MARGIN)
    plot.set_layout_engine("none")
    axes = plot.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    left = MARGIN + (wide - width) / 2
    axes.set_xlim(-left, wide + 2 * MARGIN - left)
    axes.set_ylim(height + MARGIN + FOOT, -MARGIN - HEAD)
    write(axes, MARGIN - left, -HEAD + 0.1, heading, 12, INK, weight="bold")
    return plot, axes


@lru_cache(maxsize=4096)
def text_width(text: str, size: float, bold: bool = False) -> float:
    """The width of a text in inches."""
    font = get_font(findfont(FontProperties(family=FONT, weight="bold" if bold else "normal")))
    font.set_size(size, 72)
    font.set_text(text, 0.0, flags=LoadFlags.NO_HINTING)
    return float(font.get_width_height()[0]) / 64 / 72


def write(axes: Axes, x: float, y: float, text: str, size: float, colour: str, **how: Any) -> None:
    """A text; x and y are its left end and its middle, in the units of the axes."""
    how = {"va": "center", "fontfamily": FONT, "zorder": 5, **how}
    axes.text(x, y, text, fontsize=size, color=colour, parse_math=False, **how)


def rounded(radius: float) -> str:
    """The style of a box with round corners; radius in inches."""
    return f"round,pad=0,rounding_size={radius}"


def draw_card(axes: Axes, card: Card) -> None:
    """A box with its texts."""
    x, y, width = card.box.x, card.box.y, card.box.width
    face, edge = LOOKS[card.kind]
    for top, bottom in card.cuts:
        look: dict[str, Any] = {"facecolor": face, "edgecolor": edge, "linewidth": 1.1, "zorder": 3}
        if card.is_broken:
            look |= {"edgecolor": TROUBLE, "linewidth": 1.6}
        if card.is_one_sided and not card.is_broken:
            look["linestyle"] = (0, (3, 2))
        _draw_shape(axes, card.kind, x, y + top, width, bottom - top, look)
    if len(card.cuts) > 1:
        top, bottom = card.cuts[0][1], card.cuts[-1][0]
        break_ = Line2D([x, x], [y + top, y + bottom], color=TROUBLE, linewidth=1.6, linestyle=(0, (2, 2)), zorder=2)
        axes.add_line(break_)
    for text in card.texts:
        weight = "bold" if text.role == "name" else "normal"
        write(axes, x + text.x, y + text.y, text.text, text.size, INKS[text.role], weight=weight)


def _draw_shape(axes: Axes, kind: str, x: float, y: float, width: float, height: float, look: dict[str, Any]) -> None:
    """A node is round, a topic square, a service pointed, an action has a double edge."""
    if kind == "node":
        axes.add_patch(FancyBboxPatch((x, y), width, height, rounded(min(height / 2, 0.12)), **look))
    elif kind == "service":
        tip, middle = PAD_X * 0.7, y + height / 2
        corners = [(x, middle), (x + tip, y), (x + width - tip, y)]
        corners += [(x + width, middle), (x + width - tip, y + height), (x + tip, y + height)]
        axes.add_patch(Polygon(corners, **look))
    else:
        axes.add_patch(Rectangle((x, y), width, height, **look))
        if kind == "action":
            inner = look | {"facecolor": "none", "linewidth": 0.7}
            axes.add_patch(Rectangle((x + 0.03, y + 0.03), width - 0.06, height - 0.06, **inner))


def wire_look(is_reliable: bool, is_broken: bool = False, tint: str = WIRE) -> dict[str, Any]:
    """How a line looks."""
    if is_broken:
        return {"color": TROUBLE, "linewidth": 1.6, "linestyle": (0, (4, 2.5))}
    return {"color": tint, "linewidth": 1.1, "linestyle": "-" if is_reliable else (0, (1, 1.6))}


def draw_wire(axes: Axes, wire: Wire, tint: str) -> None:
    """A line along its points, with an arrow at its end."""
    points = wire.line.points
    path, codes = [points[0]], [Path.MOVETO]
    for n, (one, other) in enumerate(itertools.pairwise(points)):
        if n % 2 == 0:  # along a row
            path.append(other)
            codes.append(Path.LINETO)
        else:  # across a gap
            middle = (one[0] + other[0]) / 2
            path += [(middle, one[1]), (middle, other[1]), other]
            codes += [Path.CURVE4] * 3
    look = wire_look(wire.reliable, wire.is_broken, tint)
    axes.add_patch(PathPatch(Path(path, codes), facecolor="none", edgecolor=look.pop("color"), zorder=1, **look))
    x, y = points[-1]
    ahead = 0.08 if x > points[-3][0] else -0.08
    colour = TROUBLE if wire.is_broken else tint
    axes.add_patch(Polygon([(x, y), (x - ahead, y - 0.035), (x - ahead, y + 0.035)], color=colour, zorder=2))
    if wire.latched:  # on the edge of the topic
        x, y = points[-1] if wire.line.outward else points[0]
        axes.plot([x], [y], marker="s", markersize=4.5, color=colour, zorder=4)


def draw_legend(axes: Axes, legend: Legend, height: float) -> None:
    """What each kind of box and line is, in a row below what is `height` inches high."""
    x, y = axes.get_xlim()[0] + MARGIN, height + FOOT
    for name, what in legend:
        if isinstance(what, dict):
            axes.add_line(Line2D([x, x + SWATCH], [y, y], **what))
        elif what == "latched":
            axes.plot([x + SWATCH / 2], [y], marker="s", markersize=4, color=WIRE)
        else:
            face, edge = LOOKS[what]
            look = {"facecolor": face, "edgecolor": edge, "linewidth": 1.1}
            _draw_shape(axes, what, x, y - 0.08, SWATCH, 0.16, look)
        write(axes, x + SWATCH + 0.08, y, name, 8, FAINT)
        x += SWATCH + 0.3 + text_width(name, 8)
