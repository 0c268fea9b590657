"""The graph as data: nodes, topics, services and actions that a node knows of, and their endpoints."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from rclpy.duration import Duration
from rclpy.node import Node, NodeNameNonExistentError
from rclpy.qos import QoSProfile
from rclpy.topic_endpoint_info import TopicEndpointInfo

from course_kit.ros.graph import discovery
from course_kit.ros.graph.snapshot import EVERY_NODES_SERVICES, EVERYWHERE, Channel, Endpoint, GraphNode, Qos, Snapshot
from course_kit.ros.private_api.rmw_parts import request_topic
from course_kit.ros.subscriptions.topics import publishers, subscriptions

NamesAndTypes = dict[str, list[str]]
FEEDBACK, FEEDBACK_TYPE = "/_action/feedback", "_FeedbackMessage"  # of an action's topic, by which it is known


@dataclass(frozen=True, order=True)
class NodeName:
    """A node's name and namespace."""

    name: str
    namespace: str

    @property
    def full_name(self) -> str:
        """The name as it is written: /namespace/name."""
        return f"{self.namespace.rstrip('/')}/{self.name}"

    @staticmethod
    def of(full_name: str) -> NodeName:
        """The node name that a full name, or a name in the root namespace, means."""
        namespace, _, name = ("/" + full_name.lstrip("/")).rpartition("/")
        return NodeName(name, namespace or "/")


def is_hidden(name: str) -> bool:
    """Return True if a part of a name begins with an underscore: such names are for tools, and not listed."""
    return any(part.startswith("_") for part in name.split("/"))


def _visible(pairs: Any, with_hidden: bool) -> NamesAndTypes:
    return {name: list(types) for name, types in sorted(pairs) if with_hidden or not is_hidden(name)}


def nodes(node: Node, with_hidden: bool = False) -> list[NodeName]:
    """The nodes, sorted by name; a name that two nodes share comes twice."""
    listed = discovery.of(node).alive(node.get_node_names_and_namespaces())
    names = [NodeName(name, namespace) for name, namespace in listed]
    return sorted((n for n in names if with_hidden or not is_hidden(n.full_name)), key=lambda n: n.full_name)


def duplicates(names: list[NodeName]) -> dict[str, int]:
    """The full names that more than one node has, and how many have it."""
    return {name: count for name, count in Counter(n.full_name for n in names).items() if count > 1}


def topics(node: Node, with_hidden: bool = False) -> NamesAndTypes:
    """{topic: types}, sorted."""
    return _visible(node.get_topic_names_and_types(), with_hidden)


def services(node: Node, with_hidden: bool = False) -> NamesAndTypes:
    """{service: types}, sorted; those that actions are made of are hidden."""
    return _visible(node.get_service_names_and_types(), with_hidden)


def actions(node: Node) -> NamesAndTypes:
    """{action: types}, sorted."""
    return _actions(topics(node, with_hidden=True))


@dataclass(frozen=True)
class Interfaces:
    """What one node offers and uses, each {name: types}."""

    subscribers: NamesAndTypes
    publishers: NamesAndTypes
    service_servers: NamesAndTypes
    service_clients: NamesAndTypes
    action_servers: NamesAndTypes
    action_clients: NamesAndTypes


def interfaces(
    node: Node, of: NodeName, with_hidden: bool = False, kept: set[tuple[str, str]] | None = None
) -> Interfaces:
    """The interfaces of the node named `of`. Raises rclpy's NodeNameNonExistentError if it has gone.

    `kept` is what _kept_names() gives, for who asks about many nodes.
    """
    who = of.name, of.namespace
    if who in (_kept_names(node) if kept is None else kept):
        ends = _by_endpoints(node, lambda info: (info.node_name, info.node_namespace) == who)
    else:
        ends = (
            node.get_subscriber_names_and_types_by_node(*who),
            node.get_publisher_names_and_types_by_node(*who),
            node.get_service_names_and_types_by_node(*who),
            node.get_client_names_and_types_by_node(*who),
        )
    return _interfaces(ends, with_hidden)


def interfaces_of(node: Node, is_one: Callable[[TopicEndpointInfo], bool], with_hidden: bool = False) -> Interfaces:
    """What those endpoints offer and use of which `is_one` says so, wherever they are."""
    return _interfaces(_by_endpoints(node, is_one), with_hidden)


def _interfaces(ends: Iterable[Iterable[tuple[str, list[str]]]], with_hidden: bool) -> Interfaces:
    subscribers, publishers, servers, clients = (dict(pairs) for pairs in ends)
    six = subscribers, publishers, servers, clients, _actions(publishers), _actions(subscribers)
    return Interfaces(*(_visible(pairs.items(), with_hidden) for pairs in six))


def _kept_names(node: Node) -> set[tuple[str, str]]:
    """The names, with namespace, under which the middleware has kept a node that has gone."""
    listed = node.get_node_names_and_namespaces()
    return set(Counter(listed) - Counter(discovery.of(node).alive(listed)))


def _actions(topics: NamesAndTypes) -> NamesAndTypes:
    """The actions whose feedback is among a node's topics: what it publishes it serves, what it hears it uses."""
    return {
        name.removesuffix(FEEDBACK): [one.removesuffix(FEEDBACK_TYPE) for one in types]
        for name, types in topics.items()
        if name.endswith(FEEDBACK)
    }


def _by_endpoints(
    node: Node, is_one: Callable[[TopicEndpointInfo], bool]
) -> tuple[Iterable[tuple[str, list[str]]], ...]:
    """The same four, from the endpoints of every topic: by name the middleware finds a node first that has gone."""

    def types(infos: Iterable[TopicEndpointInfo]) -> list[str]:
        return sorted({info.topic_type for info in infos if is_one(info)})

    names = [name for name, _ in node.get_topic_names_and_types()]
    calls = [(name, kinds, request_topic(name)) for name, kinds in node.get_service_names_and_types()]
    return (
        [(name, found) for name in names if (found := types(subscriptions(node, name)))],
        [(name, found) for name in names if (found := types(publishers(node, name)))],
        [(name, kinds) for name, kinds, asked in calls if types(node.get_subscriptions_info_by_topic(asked, True))],
        [(name, kinds) for name, kinds, asked in calls if types(node.get_publishers_info_by_topic(asked, True))],
    )


def action_clients_and_servers(node: Node, action: str) -> tuple[list[tuple[str, list[str]]], ...]:
    """The nodes that use an action and those that offer it, each as (full name, types), sorted."""
    there, kept = nodes(node, with_hidden=True), _kept_names(node)
    found = [(name.full_name, interfaces(node, name, True, kept)) for name in there]
    clients = [(name, one.action_clients[action]) for name, one in found if action in one.action_clients]
    return clients, [(name, one.action_servers[action]) for name, one in found if action in one.action_servers]


def snapshot(node: Node, hidden: bool = False, services: bool = False, actions: bool = True) -> Snapshot:
    """The whole graph as data: nodes and topics with types and QoS, actions and on request services.

    Left out unless `hidden`: names with a leading underscore, and the topics and services that every node has.
    """
    there = nodes(node, hidden)
    counts = Counter(name.full_name for name in there)
    channels = [_topic(node, name, counts) for name in topics(node, hidden) if hidden or name not in EVERYWHERE]
    if services or actions:
        channels += _calls(node, set(there), hidden, services, actions)
    # A node may have gone, or been found, between two questions: what is left of a channel then is not one.
    kept = (channel for channel in channels if channel.ends)
    return Snapshot(tuple(GraphNode(name, count) for name, count in sorted(counts.items())), tuple(sorted(kept)))


def _topic(node: Node, topic: str, known: Iterable[str]) -> Channel:
    sides = publishers(node, topic), subscriptions(node, topic)
    sources, sinks = (tuple(sorted(_endpoints(side, known))) for side in sides)
    return Channel("topic", topic, sources, sinks)


def _endpoints(infos: Iterable[TopicEndpointInfo], known: Iterable[str]) -> Iterator[Endpoint]:
    for info in infos:
        name = NodeName(info.node_name, info.node_namespace).full_name
        if name in known:  # else it is a hidden node, or one whose name has not come yet
            yield Endpoint(name, info.topic_type, qos_data(info.qos_profile))


def qos_data(profile: QoSProfile) -> Qos:
    """The policies of a profile that decide whether two ends are connected."""
    return Qos(
        profile.reliability.name.lower(),
        profile.durability.name.lower(),
        profile.liveliness.name.lower(),
        _seconds(profile.deadline),
        _seconds(profile.liveliness_lease_duration),
    )


def _seconds(duration: Duration) -> float:
    """A duration in seconds; rmw writes "no limit" as 0 or as the longest duration there is."""
    nanoseconds = duration.nanoseconds
    return nanoseconds * 1e-9 if 0 < nanoseconds < 2**63 - 1 else math.inf


def _calls(node: Node, there: set[NodeName], hidden: bool, services: bool, actions: bool) -> Iterator[Channel]:
    """The services and actions, put together from what each node offers and uses."""
    found: dict[tuple[str, str], tuple[list[Endpoint], list[Endpoint]]] = {}

    def note(kind: str, side: int, owner: NodeName, pairs: NamesAndTypes) -> None:
        for name, types in pairs.items():
            if kind == "action" or hidden or name.rpartition("/")[2] not in EVERY_NODES_SERVICES:
                ends = found.setdefault((kind, name), ([], []))
                ends[side].extend(Endpoint(owner.full_name, type_name) for type_name in types)

    kept = _kept_names(node)
    for owner in sorted(there):
        try:
            offered = interfaces(node, owner, hidden, kept)
        except NodeNameNonExistentError:  # it ended meanwhile
            continue
        if services:
            note("service", 0, owner, offered.service_clients)
            note("service", 1, owner, offered.service_servers)
        if actions:
            note("action", 0, owner, offered.action_clients)
            note("action", 1, owner, offered.action_servers)
    for (kind, name), (clients, servers) in found.items():
        yield Channel(kind, name, tuple(sorted(clients)), tuple(sorted(servers)))
