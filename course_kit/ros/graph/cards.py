"""The boxes of a drawn graph, and the lines to them: names, types, QoS in words, faults."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from course_kit.ros.graph.layers import Box, Line
from course_kit.ros.graph.matching import SIDES, Part, explanations, parts
from course_kit.ros.graph.snapshot import Channel, Endpoint, GraphNode, Qos, Snapshot

Measure = Callable[[str, float, bool], float]  # the width in inches of a text, its size in points, whether it is bold

ROOT = "/"
NAME, SMALL = 8.5, 7.2  # points
LEADING = 1.3 / 72  # inches a point of a line of text
PAD_X, PAD_Y, APART = 0.1, 0.05, 0.07
LONGEST, WRAP = 34, 42  # characters
MANY = 12  # nodes or topics from which each gets one line, so that sixty fit


@dataclass(frozen=True)
class Text:
    """A piece of text in a card; `x` from its left side, `y` of its middle, from its top."""

    text: str
    x: float
    y: float
    size: float
    role: str  # name, detail or trouble


@dataclass
class Card:
    """One box and its texts. `cuts` are top and bottom of each part; only what is broken has several."""

    box: Box
    kind: str  # node, topic, service or action
    texts: list[Text]
    cuts: list[tuple[float, float]]
    is_broken: bool = False
    is_one_sided: bool = False


@dataclass
class Wire:
    """A line and how it is drawn."""

    line: Line
    reliable: bool
    latched: bool
    is_broken: bool


def cards(shown: Snapshot, measure: Measure) -> tuple[list[Card], list[Wire], dict[str, float]]:
    """The boxes and lines of a graph, and the namespaces that get a band with the widths of their titles."""
    detailed = len(shown.nodes) <= MANY and len(shown.channels) <= MANY + 4
    namespaces = {node.namespace for node in shown.nodes}
    made = [_node_card(node, measure) for node in shown.nodes]
    wires: list[Wire] = []
    for channel in shown.channels:
        split = parts(channel)
        made.append(_channel_card(channel, split, _group(channel.name, namespaces), detailed, measure))
        wires += _wires(channel, split)
    titles = {name: measure(name, NAME, True) + 0.05 for name in namespaces - {ROOT}}
    return made, wires, titles


def _group(name: str, namespaces: set[str]) -> str:
    """The innermost namespace in which a topic and some node are."""
    while name:
        name = name.rpartition("/")[0]
        if name in namespaces:
            return name
    return ROOT


def _relative(name: str, group: str) -> str:
    short = name if group == ROOT else name.removeprefix(f"{group}/")
    return short if len(short) <= LONGEST else f"{short[: LONGEST // 2 - 1]}…{short[-LONGEST // 2 :]}"


def _node_card(node: GraphNode, measure: Measure) -> Card:
    rows = [(_relative(node.name, node.namespace), NAME, "name")]
    if node.count > 1:
        rows.append((f"{node.count} nodes of this name", SMALL, "trouble"))
    for one in node.parameters or ():
        shown = textwrap.shorten(f"{one.name}: {one.value}", LONGEST, placeholder="…")
        rows.append((f"{shown}  {one.type}", SMALL, "detail"))
    texts, height = stacked(rows, PAD_Y)
    width = widest(texts, measure) + 2 * PAD_X
    port = stacked(rows[:1], PAD_Y)[1] / 2 if len(rows) > 1 else height / 2
    box = Box(f"node {node.name}", node.namespace, True, width, height, (port,))
    return Card(box, "node", texts, [(0.0, height)], is_broken=node.count > 1)


def stacked(rows: Iterable[tuple[str, float, str]], top: float) -> tuple[list[Text], float]:
    """Lines of text below one another, and where the next thing may begin."""
    texts, y = [], top
    for text, size, role in rows:
        texts.append(Text(text, PAD_X, y + size * LEADING / 2, size, role))
        y += size * LEADING
    return texts, y + PAD_Y


def widest(texts: list[Text], measure: Measure) -> float:
    """The width in inches that these texts take."""
    return max(text.x - PAD_X + measure(text.text, text.size, text.role == "name") for text in texts)


def _channel_card(channel: Channel, split: list[Part], group: str, detailed: bool, measure: Measure) -> Card:
    reasons = [f"✗ {line}" for line in explanations(channel, split)]
    name = _relative(channel.name, group)
    note = _missing_side(channel)
    is_unheard = bool(channel.sources) and channel.kind == "topic"
    texts: list[Text] = []
    cuts, y = [], 0.0
    for n, part in enumerate(split):
        top = y = y + (APART if n > 1 else 0.0)
        kind = part.type if detailed else part.type.rpartition("/")[2]
        rows = [(name, NAME, "name")]
        if detailed:
            lines = [kind, *(qos_lines(part) if channel.kind == "topic" else ())]
            rows += [(line, SMALL, "detail") for line in lines]
        if note and n == 0 and (detailed or not is_unheard):  # that nobody listens the end of the line says too
            rows.append((note, SMALL, "detail" if is_unheard else "trouble"))
        written, y = stacked(rows, y + PAD_Y)
        if not detailed:
            first = written[0]
            beside = first.x + measure(name, NAME, True) + 0.08
            written.insert(1, Text(kind, beside, first.y + 0.005, SMALL, "detail"))
        texts += written
        cuts.append((top, y))
        if n == 0 and reasons:
            lines = [piece for line in reasons[:4] for piece in textwrap.wrap(line, WRAP, subsequent_indent="   ")]
            if len(reasons) > 4:
                lines.append(f"   and {len(reasons) - 4} more")
            written, y = stacked([(line, SMALL, "trouble") for line in lines], y + PAD_Y)
            texts += written
    ports = tuple((top + bottom) / 2 for top, bottom in cuts)
    box = Box(f"{channel.kind} {channel.name}", group, False, widest(texts, measure) + 2 * PAD_X, y, ports)
    return Card(box, channel.kind, texts, cuts, bool(reasons), bool(note))


def _missing_side(channel: Channel) -> str:
    source, sink = SIDES[channel.kind]
    if not channel.sources:
        return f"no {source}"
    return "" if channel.sinks else f"no {sink}"


def qos_lines(part: Part) -> list[str]:
    """The QoS of a part in words: one line if all ends agree, else what is offered and what is asked for."""
    offered, asked = (" or ".join(sorted({qos_words(e.qos) for e in ends})) for ends in (part.sources, part.sinks))
    if offered == asked or not (offered and asked):
        return [offered or asked]
    return [f"offers {offered}", f"asks for {asked}"]


def qos_words(qos: Qos) -> str:
    """A QoS as one would say it: 'reliable', 'best effort, deadline 0.1 s'."""
    words = [qos.reliability.replace("_", " ")]
    if qos.durability != "volatile":
        words.append(qos.durability.replace("_", " "))
    if qos.deadline != float("inf"):
        words.append(f"deadline {qos.deadline:g} s")
    if qos.liveliness != "automatic":
        words.append(f"liveliness {qos.liveliness.replace('_', ' ')}")
    if qos.lease != float("inf"):
        words.append(f"lease {qos.lease:g} s")
    return ", ".join(words)


def _wires(channel: Channel, split: list[Part]) -> list[Wire]:
    """One line for each node, part and direction; it shows the weakest of the ends that it stands for."""
    found: list[Wire] = []
    both = bool(channel.sources and channel.sinks)
    for n, part in enumerate(split):
        for outward, ends in ((True, part.sources), (False, part.sinks)):
            by_node: dict[str, list[Endpoint]] = {}
            for end in ends:
                by_node.setdefault(end.node, []).append(end)
            for node, of_node in by_node.items():
                reliable = all(end.qos.reliability != "best_effort" for end in of_node)
                latched = any(end.qos.durability == "transient_local" for end in of_node)
                broken = both and not (part.sources and part.sinks)
                bundle = f"{reliable} {broken}"
                line = Line(f"node {node}", f"{channel.kind} {channel.name}", n, outward, bundle)
                found.append(Wire(line, reliable, latched, broken))
    return found
