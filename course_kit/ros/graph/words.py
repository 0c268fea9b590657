"""The graph in words: what its picture shows, for who does not see that."""

from __future__ import annotations

from collections.abc import Iterable

from course_kit.ros.graph.cards import qos_lines
from course_kit.ros.graph.matching import explanations, parts
from course_kit.ros.graph.snapshot import Channel, GraphNode, Snapshot

# What the nodes on both sides of each kind do.
SAID = {"topic": ("published by", "subscribed by"), "service": ("called by", "served by")}
SAID["action"] = SAID["service"]


def heading(shown: Snapshot) -> str:
    """How many there are of each kind, and of how many the ends do not match."""
    counts = [(sum(node.count for node in shown.nodes), "node")]
    counts += [(len(some), name) for some, name in ((shown.topics, "topic"), (shown.services, "service"))]
    counts.append((len(shown.actions), "action"))
    text = ", ".join(f"{n} {name}{'s' if n != 1 else ''}" for n, name in counts if n or name in ("node", "topic"))
    broken = sum(1 for channel in shown.channels if explanations(channel))
    return text + (f"  ·  {broken} with ends that do not match" if broken else "")


def in_words(shown: Snapshot) -> str:
    """All nodes; of each topic, service and action its types, its QoS, who is on which side, what does not match."""
    if not shown.nodes:
        return "No node runs in this domain."
    lines = [f"{heading(shown)}.", f"Nodes: {', '.join(_node(node) for node in shown.nodes)}."]
    return " ".join(lines + [_channel(channel) for channel in shown.channels])


def _node(node: GraphNode) -> str:
    notes = [f"{node.count} nodes of this name"] if node.count > 1 else []
    notes += [f"{one.name} = {one.value}" for one in node.parameters or ()]
    return f"{node.name} ({', '.join(notes)})" if notes else node.name


def _channel(channel: Channel) -> str:
    split = parts(channel)
    known = [" and ".join(channel.types)]
    if channel.kind == "topic":
        known.append(" / ".join(dict.fromkeys(line for part in split for line in qos_lines(part))))
    sides = [
        f"{said} {_names(end.node for end in ends)}"
        for said, ends in zip(SAID[channel.kind], (channel.sources, channel.sinks), strict=True)
    ]
    reasons = "".join(f" Does not match: {line}." for line in explanations(channel, split))
    return f"{channel.kind.capitalize()} {channel.name} ({', '.join(known)}): {', '.join(sides)}.{reasons}"


def _names(nodes: Iterable[str]) -> str:
    return " and ".join(dict.fromkeys(nodes)) or "nobody"
