"""A graph of nodes as plain data: what plots and views draw, and tests compare. No ROS is needed to read it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

# Every node has these; they are of interest only to who asks for hidden things.
EVERYWHERE = frozenset({"/rosout", "/parameter_events"})
EVERY_NODES_SERVICES = frozenset({
    "describe_parameters", "get_parameter_types", "get_parameters", "list_parameters", "set_parameters",
    "set_parameters_atomically", "get_type_description",
})  # fmt: skip


@dataclass(frozen=True, order=True)
class Qos:
    """What decides whether two ends of a topic are connected. Times in seconds; no limit is inf."""

    reliability: str = "reliable"  # or best_effort
    durability: str = "volatile"  # or transient_local
    liveliness: str = "automatic"  # or manual_by_topic
    deadline: float = math.inf
    lease: float = math.inf


@dataclass(frozen=True, order=True)
class Endpoint:
    """One end of a topic, service or action: the full name of its node, its type, its QoS."""

    node: str
    type: str
    qos: Qos = Qos()


@dataclass(frozen=True, order=True)
class Channel:
    """A topic, service or action, with both its sides.

    `sources` are publishers, or clients of a service or action; `sinks` are subscriptions, or servers.
    """

    kind: str  # topic, service or action
    name: str
    sources: tuple[Endpoint, ...] = ()
    sinks: tuple[Endpoint, ...] = ()

    @property
    def ends(self) -> tuple[Endpoint, ...]:
        """All endpoints of the channel."""
        return self.sources + self.sinks

    @property
    def types(self) -> list[str]:
        """Its types, sorted; more than one is a mistake."""
        return sorted({end.type for end in self.ends})


@dataclass(frozen=True, order=True)
class Parameter:
    """A parameter of a node; its value as text."""

    name: str
    type: str
    value: str


@dataclass(frozen=True, order=True)
class GraphNode:
    """A node by its full name; `count` is above one if several nodes share the name.

    `parameters` is None if they were not asked for or the node did not answer.
    """

    name: str
    count: int = 1
    parameters: tuple[Parameter, ...] | None = None

    @property
    def namespace(self) -> str:
        """What the node's name has in front of its last slash; `/` if nothing."""
        return self.name.rpartition("/")[0] or "/"


def _of_kind(kind: str) -> property:
    return property(lambda shown: [channel for channel in shown.channels if channel.kind == kind])


@dataclass(frozen=True)
class Snapshot:
    """The graph at one moment; equal to another one if nothing that can be drawn has changed."""

    nodes: tuple[GraphNode, ...] = ()
    channels: tuple[Channel, ...] = ()

    topics, services, actions = map(_of_kind, ("topic", "service", "action"))

    def around(self, node: str | None = None, namespace: str | None = None) -> Snapshot:
        """What a node, or the nodes of a namespace, have to do with, and the nodes at the other ends of it.

        Both by their full names. ValueError if there is no such node.
        """
        if node is None and namespace is None:
            return self
        inside = {n.name for n in self.nodes if (node in (None, n.name)) and _is_within(n, namespace)}
        if not inside:
            wanted = f"node {node}" if node is not None else f"node in the namespace {namespace}"
            known = ", ".join(n.name for n in self.nodes) or "none"
            raise ValueError(f"there is no {wanted}; the nodes are: {known}")
        kept = tuple(c for c in self.channels if any(end.node in inside for end in c.ends))
        drawn = inside | {end.node for channel in kept for end in channel.ends}
        return replace(self, nodes=tuple(n for n in self.nodes if n.name in drawn), channels=kept)


def _is_within(node: GraphNode, namespace: str | None) -> bool:
    return f"{node.namespace.rstrip('/')}/".startswith(f"{(namespace or '').rstrip('/')}/")
