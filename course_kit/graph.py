"""Who talks to whom, as data: nodes, topics, services and actions that a node knows of, and their endpoints."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import Any

from rclpy.node import Node
from rclpy.topic_endpoint_info import TopicEndpointInfo

NamesAndTypes = dict[str, list[str]]
ACTION_PARTS = ("/_action/send_goal", "/_action/cancel_goal", "/_action/get_result")


@dataclass(frozen=True, order=True)
class NodeName:
    """A node's name and namespace."""

    name: str
    namespace: str

    @property
    def full_name(self) -> str:
        """The name as it is written: /namespace/name."""
        return f"{self.namespace.rstrip('/')}/{self.name}"

    @property
    def is_hidden(self) -> bool:
        return is_hidden(self.full_name)

    @staticmethod
    def of(full_name: str) -> NodeName:
        """The node name that a full name, or a name in the root namespace, means."""
        namespace, _, name = ("/" + full_name.lstrip("/")).rpartition("/")
        return NodeName(name, namespace or "/")


def is_hidden(name: str) -> bool:
    """Whether a part of a name begins with an underscore: such names are for tools, and not listed."""
    return any(part.startswith("_") for part in name.split("/"))


def _visible(pairs: Any, with_hidden: bool) -> NamesAndTypes:
    return {name: list(types) for name, types in sorted(pairs) if with_hidden or not is_hidden(name)}


def nodes(node: Node, with_hidden: bool = False) -> list[NodeName]:
    """The nodes, sorted by name; a name that two nodes share comes twice."""
    names = [NodeName(name, namespace) for name, namespace in node.get_node_names_and_namespaces()]
    return sorted((n for n in names if with_hidden or not n.is_hidden), key=lambda n: n.full_name)


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
    from rclpy.action import get_action_names_and_types

    return _visible(get_action_names_and_types(node), True)


def publishers(node: Node, topic: str) -> list[TopicEndpointInfo]:
    """The publishers of a topic."""
    found: list[TopicEndpointInfo] = node.get_publishers_info_by_topic(topic)
    return found


def subscriptions(node: Node, topic: str) -> list[TopicEndpointInfo]:
    """The subscriptions to a topic."""
    found: list[TopicEndpointInfo] = node.get_subscriptions_info_by_topic(topic)
    return found


@dataclass(frozen=True)
class Interfaces:
    """What one node offers and uses, each {name: types}."""

    subscribers: NamesAndTypes
    publishers: NamesAndTypes
    service_servers: NamesAndTypes
    service_clients: NamesAndTypes
    action_servers: NamesAndTypes
    action_clients: NamesAndTypes


def interfaces(node: Node, of: NodeName, with_hidden: bool = False) -> Interfaces:
    """The interfaces of the node named `of`. Raises rclpy's NodeNameNonExistentError if it has gone."""
    from rclpy.action import (
        get_action_client_names_and_types_by_node,
        get_action_server_names_and_types_by_node,
    )

    who = of.name, of.namespace
    return Interfaces(
        subscribers=_visible(node.get_subscriber_names_and_types_by_node(*who), with_hidden),
        publishers=_visible(node.get_publisher_names_and_types_by_node(*who), with_hidden),
        service_servers=_visible(node.get_service_names_and_types_by_node(*who), with_hidden),
        service_clients=_visible(node.get_client_names_and_types_by_node(*who), with_hidden),
        action_servers=_visible(get_action_server_names_and_types_by_node(node, *who), with_hidden),
        action_clients=_visible(get_action_client_names_and_types_by_node(node, *who), with_hidden),
    )


def action_clients_and_servers(node: Node, action: str) -> tuple[list[tuple[str, list[str]]], ...]:
    """The nodes that use an action and those that offer it, each as (full name, types), sorted."""
    clients, servers = [], []
    for name in nodes(node, with_hidden=True):
        offered = interfaces(node, name, with_hidden=True)
        if action in offered.action_clients:
            clients.append((name.full_name, offered.action_clients[action]))
        if action in offered.action_servers:
            servers.append((name.full_name, offered.action_servers[action]))
    return clients, servers
