"""The graph as a picture: nodes, and the topics, services and actions between them, from left to right."""

from __future__ import annotations

from typing import Any

from matplotlib.patches import FancyBboxPatch
from rclpy.node import Node

from course_kit.base.arguments import NAMESPACE, NODE
from course_kit.base.figures import FAINT, LINES, Plot
from course_kit.ros.graph import discovery, graph, words
from course_kit.ros.graph.cards import NAME, Card, Wire, cards
from course_kit.ros.graph.drawing import (
    LOOKS,
    WIRE,
    Legend,
    draw_card,
    draw_legend,
    draw_wire,
    rounded,
    sheet,
    text_width,
    wire_look,
    write,
)
from course_kit.ros.graph.layout import lay_out
from course_kit.ros.graph.snapshot import Snapshot
from course_kit.ros.subscriptions import observer_node

CROWD = 30  # boxes
# Lines of one topic have one of these, so that the eye can follow them through a crowd; none is near TROUBLE.
WIRES = ("#5d6b7a", "#2f7f86", "#7b5f99", "#6d7a2f", "#3f63a8")


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
    check_part(node, namespace)
    return draw_graph(look(observer(), node, namespace, hidden, services, actions, parameters))


def check_part(node: Any, namespace: str | None) -> None:
    """Refuse a part of the graph that cannot be one, before the graph is waited for."""
    (NAMESPACE | None).check("namespace", namespace)
    _full_name(node)


def observer() -> Node:
    """The node of the instruments, once it knows the whole graph as it is now."""
    node = observer_node.node()
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
    within = None if namespace is None else "/" + namespace.strip("/")
    there = graph.snapshot(watching, hidden, services, actions).around(_full_name(node), within)
    if parameters:
        from course_kit.ros.graph.parameters import with_parameters

        there = with_parameters(there, watching, hidden)
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
    legend = _legend(made, wires)
    plot, axes = sheet(words.heading(shown), legend, layout.width, layout.height)
    for band in layout.bands:
        look: dict[str, Any] = {"facecolor": "#ecece6", "edgecolor": LINES, "linewidth": 1.0, "zorder": 0}
        axes.add_patch(FancyBboxPatch((band.x, band.y), band.width, band.height, rounded(0.06), **look))
        write(axes, band.x + 0.09, band.y + 0.13, band.group, NAME, FAINT, weight="bold")
    tints = {card.box.key: WIRES[n % len(WIRES)] for n, card in enumerate(made)} if len(made) > CROWD else {}
    for wire in wires:
        draw_wire(axes, wire, tints.get(wire.line.box, WIRE))
    for card in made:
        draw_card(axes, card)
    if not shown.nodes:
        write(axes, layout.width / 2, layout.height, "no node runs in this domain", 10, FAINT, ha="center")
    draw_legend(axes, legend, layout.height)
    plot.description = words.in_words(shown)
    return plot


def _legend(made: list[Card], wires: list[Wire]) -> Legend:
    """What the picture has of each kind."""
    kinds = {card.kind for card in made}
    connected = {wire.reliable for wire in wires if wire.line.box.startswith("topic ") and not wire.is_broken}
    found: Legend = [(kind, kind) for kind in LOOKS if kind in kinds]
    found += [(name, wire_look(how)) for name, how in (("reliable", True), ("best effort", False)) if how in connected]
    if any(wire.latched for wire in wires):
        found.append(("transient local", "latched"))
    if any(wire.is_broken for wire in wires):
        found.append(("does not match", wire_look(True, is_broken=True)))
    return found
