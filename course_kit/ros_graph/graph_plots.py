"""The graph as a picture: nodes, and the topics, services and actions between them, from left to right."""

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
from rclpy.node import Node

from course_kit.arguments import NAMESPACE, NODE
from course_kit.figures import COLOURS, FAINT, INK, LINES, PANEL, Plot
from course_kit.ros_graph import discovery, graph, graph_words
from course_kit.ros_graph.graph_cards import NAME, PAD_X, Card, Wire, cards
from course_kit.ros_graph.graph_data import Snapshot
from course_kit.ros_graph.graph_layout import lay_out
from course_kit.watching import instruments

FONT = "DejaVu Sans"  # it comes with matplotlib, so widths are the same everywhere
MARGIN, HEAD, FOOT = 0.22, 0.42, 0.3  # inches
NARROWEST = 6.0
CROWD = 30  # boxes
SWATCH = 0.34  # inches of the legend's lines
TROUBLE, TROUBLE_INK = COLOURS[1], "#a33c00"
WIRE = "#6f7780"
# Lines of one topic have one of these, so that the eye can follow them through a crowd; none is near TROUBLE.
WIRES = ("#5d6b7a", "#2f7f86", "#7b5f99", "#6d7a2f", "#3f63a8")
# Face and edge of what can stand in a graph.
LOOKS = {
    "node": ("#dcebf7", COLOURS[0]),
    "topic": (PANEL, "#8a8a84"),
    "service": ("#dff3ea", COLOURS[2]),
    "action": ("#f9e8f1", "#c0609b"),
}
INKS = {"name": INK, "detail": FAINT, "trouble": TROUBLE_INK}


def plot_graph(
    node: Any = None,
    namespace: str | None = None,
    hidden: bool = False,
    services: bool = False,
    actions: bool = True,
    parameters: bool = False,
) -> Plot:
    """Draw who talks to whom now: nodes and topics with types and QoS, namespaces, and what cannot match with why.

    All of the graph, or what a `node` (itself or its name) or the nodes of a `namespace` have to do with. Actions are
    drawn unless `actions=False`; `services` and `parameters` on request. `hidden` adds names that begin with an
    underscore, /rosout, /parameter_events and the services that every node has. Raises ValueError if there is no
    such node. Stands for rqt_graph.
    """
    return draw_graph(look(observer(), node, namespace, hidden, services, actions, parameters))


def observer() -> Node:
    """The node of the instruments, once it knows the whole graph as it is now."""
    node = instruments.node()
    discovery.of(node, keep=True).wait()
    return node


def look(
    watching: Node,
    node: Any = None,
    namespace: str | None = None,
    hidden: bool = False,
    services: bool = False,
    actions: bool = True,
    parameters: bool = False,
) -> Snapshot:
    """The graph as the node `watching` sees it now, as data; the rest is what plot_graph() takes."""
    (NAMESPACE | None).check("namespace", namespace)
    within = None if namespace is None else "/" + namespace.strip("/")
    there = graph.snapshot(watching, hidden, services, actions).around(_full_name(node), within)
    if parameters:
        from course_kit.ros_graph import graph_parameters

        there = graph_parameters.with_parameters(there, watching, hidden)
    return there


def _full_name(node: Any) -> str | None:
    if node is None:
        return None
    if isinstance(node, str):
        NODE.check("node", node)
        return graph.NodeName.of(node).full_name
    if hasattr(node, "get_fully_qualified_name"):
        return str(node.get_fully_qualified_name())
    raise TypeError(f"node is a node or its name, not {type(node).__name__}")


def draw_graph(shown: Snapshot) -> Plot:
    """The picture of a graph that is given as data."""
    made, wires, titles = cards(shown, text_width)
    layout = lay_out([card.box for card in made], [wire.line for wire in wires], titles)
    heading = graph_words.heading(shown)
    legend = _legend(made, wires)
    of_legend = sum(SWATCH + 0.3 + text_width(name, 8) for name, _ in legend)
    wide = max(layout.width, text_width(heading, 12, True), of_legend, NARROWEST - 2 * MARGIN)
    width, height = wide + 2 * MARGIN, layout.height + HEAD + FOOT + 2 * MARGIN
    plot = Plot(width, height)
    plot.set_layout_engine("none")
    axes = plot.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    left = MARGIN + (wide - layout.width) / 2
    axes.set_xlim(-left, width - left)
    axes.set_ylim(height - MARGIN - HEAD, -MARGIN - HEAD)
    _write(axes, MARGIN - left, -HEAD + 0.1, heading, 12, INK, weight="bold")
    for band in layout.bands:
        look: dict[str, Any] = {"facecolor": "#ecece6", "edgecolor": LINES, "linewidth": 1.0, "zorder": 0}
        axes.add_patch(FancyBboxPatch((band.x, band.y), band.width, band.height, _round(0.06), **look))
        _write(axes, band.x + 0.09, band.y + 0.13, band.group, NAME, FAINT, weight="bold")
    tints = {card.box.key: WIRES[n % len(WIRES)] for n, card in enumerate(made)} if len(made) > CROWD else {}
    for wire in wires:
        _draw_wire(axes, wire, tints.get(wire.line.box, WIRE))
    for card in made:
        _draw_card(axes, card)
    if not shown.nodes:
        _write(axes, width / 2 - left, layout.height, "no node runs in this domain", 10, FAINT, ha="center")
    _draw_legend(axes, legend, MARGIN - left, layout.height + FOOT)
    plot.description = graph_words.in_words(shown)
    return plot


@lru_cache(maxsize=4096)
def text_width(text: str, size: float, bold: bool = False) -> float:
    """The width of a text in inches."""
    font = get_font(findfont(FontProperties(family=FONT, weight="bold" if bold else "normal")))
    font.set_size(size, 72)
    font.set_text(text, 0.0, flags=LoadFlags.NO_HINTING)
    return float(font.get_width_height()[0]) / 64 / 72


def _write(axes: Axes, x: float, y: float, text: str, size: float, colour: str, **how: Any) -> None:
    how = {"va": "center", "fontfamily": FONT, "zorder": 5, **how}
    axes.text(x, y, text, fontsize=size, color=colour, parse_math=False, **how)


def _round(radius: float) -> str:
    return f"round,pad=0,rounding_size={radius}"


def _draw_card(axes: Axes, card: Card) -> None:
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
        _write(axes, x + text.x, y + text.y, text.text, text.size, INKS[text.role], weight=weight)


def _draw_shape(axes: Axes, kind: str, x: float, y: float, width: float, height: float, look: dict[str, Any]) -> None:
    """A node is round, a topic square, a service pointed, an action has a double edge."""
    if kind == "node":
        axes.add_patch(FancyBboxPatch((x, y), width, height, _round(min(height / 2, 0.12)), **look))
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


def _wire_look(is_reliable: bool, is_broken: bool = False, tint: str = WIRE) -> dict[str, Any]:
    if is_broken:
        return {"color": TROUBLE, "linewidth": 1.6, "linestyle": (0, (4, 2.5))}
    return {"color": tint, "linewidth": 1.1, "linestyle": "-" if is_reliable else (0, (1, 1.6))}


def _draw_wire(axes: Axes, wire: Wire, tint: str) -> None:
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
    look = _wire_look(wire.reliable, wire.is_broken, tint)
    axes.add_patch(PathPatch(Path(path, codes), facecolor="none", edgecolor=look.pop("color"), zorder=1, **look))
    x, y = points[-1]
    ahead = 0.08 if x > points[-3][0] else -0.08
    colour = TROUBLE if wire.is_broken else tint
    axes.add_patch(Polygon([(x, y), (x - ahead, y - 0.035), (x - ahead, y + 0.035)], color=colour, zorder=2))
    if wire.latched:  # on the edge of the topic
        x, y = points[-1] if wire.line.outward else points[0]
        axes.plot([x], [y], marker="s", markersize=4.5, color=colour, zorder=4)


Legend = list[tuple[str, dict[str, Any] | str]]  # names; how their lines look, or what stands there


def _legend(made: list[Card], wires: list[Wire]) -> Legend:
    """What the picture has of each kind."""
    kinds = {card.kind for card in made}
    connected = {wire.reliable for wire in wires if wire.line.box.startswith("topic ") and not wire.is_broken}
    found: Legend = [(kind, kind) for kind in LOOKS if kind in kinds]
    found += [(name, _wire_look(how)) for name, how in (("reliable", True), ("best effort", False)) if how in connected]
    if any(wire.latched for wire in wires):
        found.append(("transient local", "latched"))
    if any(wire.is_broken for wire in wires):
        found.append(("does not match", _wire_look(True, is_broken=True)))
    return found


def _draw_legend(axes: Axes, legend: Legend, x: float, y: float) -> None:
    for name, what in legend:
        if isinstance(what, dict):
            axes.add_line(Line2D([x, x + SWATCH], [y, y], **what))
        elif what == "latched":
            axes.plot([x + SWATCH / 2], [y], marker="s", markersize=4, color=WIRE)
        else:
            face, edge = LOOKS[what]
            look = {"facecolor": face, "edgecolor": edge, "linewidth": 1.1}
            _draw_shape(axes, what, x, y - 0.08, SWATCH, 0.16, look)
        _write(axes, x + SWATCH + 0.08, y, name, 8, FAINT)
        x += SWATCH + 0.3 + text_width(name, 8)
