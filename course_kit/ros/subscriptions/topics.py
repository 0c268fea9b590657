"""Topics by name: their types in the graph, the QoS that fits their publishers."""

from __future__ import annotations

import difflib
import time
from collections.abc import Sequence
from typing import Any

from rclpy.exceptions import InvalidTopicNameException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.topic_endpoint_info import TopicEndpointInfo
from rclpy.validate_full_topic_name import validate_full_topic_name

from course_kit.base.arguments import TEXT, shown
from course_kit.base.long_tasks import long_task
from course_kit.base.polling import wait_until
from course_kit.ros import interface_types
from course_kit.ros.interface_types import message_class

UNKNOWN_NODE = "_NODE_NAME_UNKNOWN_"  # as rmw has it
UNNAMED = "a node whose name has not arrived yet"
MATCH_TIMEOUT = 2.0  # seconds given to publishers and subscriptions that are there already to find each other
MISMATCH_TIMEOUT = 3.0  # seconds after which those that have not found each other do not fit
# How many messages the middleware keeps while Python is busy elsewhere; it takes memory only for those that wait.
DEPTH = 100_000
# By convention these are published once and kept for whoever subscribes later.
LATCHED = frozenset({"/rosout", "/tf_static", "/robot_description"})


def absolute(topic: str) -> str:
    """The full name of a topic: a relative name is taken as one of the root namespace. ValueError if it is none."""
    TEXT.check("the name of a topic", topic)
    name = topic if topic.startswith("/") else f"/{topic}"
    try:
        validate_full_topic_name(name)
    except InvalidTopicNameException as error:
        reason = " ".join(str(error).split("\n")[0].split()).rstrip(":")
        raise ValueError(
            f"{shown(topic)} cannot be the name of a topic. {reason}. Write it like '/turtle1/pose'."
        ) from None
    return name


def type_name(message_type: Any) -> str:
    """The name of a message class, such as 'std_msgs/msg/String'. TypeError if it is no message class."""
    if not (isinstance(message_type, type) and hasattr(message_type, "get_fields_and_field_types")):
        raise TypeError(
            f"{message_type!r} is not a message type: give a class such as std_msgs.msg.String, or its name"
        )
    return interface_types.type_name(message_type)


def node_name(endpoint: TopicEndpointInfo) -> str:
    """The full name of the node that an endpoint belongs to."""
    if endpoint.node_name == UNKNOWN_NODE:
        return UNNAMED
    return f"{endpoint.node_namespace.rstrip('/')}/{endpoint.node_name}"


def publishers(node: Node, topic: str) -> list[TopicEndpointInfo]:
    """The publishers of a topic that the graph knows now."""
    return node.get_publishers_info_by_topic(topic)


def subscriptions(node: Node, topic: str) -> list[TopicEndpointInfo]:
    """The subscriptions to a topic that the graph knows now."""
    return node.get_subscriptions_info_by_topic(topic)


def published(node: Node) -> list[str]:
    """The topics that some node publishes, without those that every node has."""
    there = [name for name, _ in node.get_topic_names_and_types()]
    return [n for n in there if n not in ("/rosout", "/parameter_events") and node.count_publishers(n)]


def wait_for_type(node: Node, topic: str, timeout: float) -> str:
    """The type of a topic; waits up to `timeout` seconds for a node that publishes it or subscribes to it.

    Raises TimeoutError if none comes, TypeError if the topic carries two types.
    """
    types = wait_until(lambda: _types(node, topic), timeout)
    if not types:
        raise TimeoutError(f"no node publishes {topic} (waited {timeout:.3g} s).{_hint(node, topic)}")
    if len(types) > 1:
        raise TypeError(
            f"{topic} carries {len(types)} types: {_who_publishes(node, topic)}. Nodes that share a topic must agree "
            f"on its type, so rename one topic; or say which type you want, as in '{topic}', '{types[0]}'."
        )
    return types[0]


def _types(node: Node, topic: str) -> list[str]:
    published = sorted({p.topic_type for p in publishers(node, topic)})
    return published or dict(node.get_topic_names_and_types()).get(topic, [])


def _who_publishes(node: Node, topic: str) -> str:
    # A publisher may be known a little before the name of its node is.
    wait_until(lambda: all(p.node_name != UNKNOWN_NODE for p in publishers(node, topic)), 1.0)
    return ", ".join(sorted({f"{p.topic_type} from {node_name(p)}" for p in publishers(node, topic)}))


def check_type(node: Node, topic: str, wanted: str) -> None:
    """Raise TypeError if a topic is published, but with no publisher of the type `wanted`."""
    if not _carries_only_others(node, topic, wanted):
        return
    who = _who_publishes(node, topic)  # which may take a moment, in which more becomes known
    if _carries_only_others(node, topic, wanted):
        raise TypeError(
            f"{topic} does not carry {wanted} but {who}: a subscription of another type receives nothing. "
            f"Leave the type out, and it is looked up."
        )


def _carries_only_others(node: Node, topic: str, wanted: str) -> bool:
    types = {p.topic_type for p in publishers(node, topic)}
    return bool(types) and wanted not in types


def _hint(node: Node, topic: str) -> str:
    """What a student may have meant, or what is there instead."""
    there = published(node)
    last = topic.rsplit("/", 1)[-1]
    near = [n for n in there if n.rsplit("/", 1)[-1] == last]
    near += [n for n in difflib.get_close_matches(topic, there, n=3) if n not in near]
    if near:
        return f" Did you mean {' or '.join(near[:3])}?"
    if there:
        return f" Published are: {', '.join(sorted(there)[:8])}."
    return " No node publishes anything here: is the node running, in the same ROS_DOMAIN_ID?"


def with_types(wanted: Sequence[Any]) -> dict[str, Any]:
    """Topic names with the message class that follows each, or None: ('/a', '/b', String) names no type for /a."""
    pairs: dict[str, Any] = {}
    for item in wanted:
        is_type_name = isinstance(item, str) and not item.startswith("/") and "/msg/" in item
        if isinstance(item, str) and not is_type_name:
            pairs[absolute(item)] = None
        elif not pairs:
            raise TypeError(f"give topic names first and their types after them: '/topic', {item!r}")
        else:
            given = message_class(item) if is_type_name else item
            type_name(given)  # refuses what is no message type
            pairs[next(reversed(pairs))] = given
    if not pairs:
        raise TypeError("give the names of topics, such as '/turtle1/pose'")
    return pairs


def look_up(node: Node, pairs: dict[str, Any], timeout: float) -> dict[str, Any]:
    """Fill in the types that are None from the graph; waits up to `timeout` seconds in all, as wait_for_type()."""
    deadline = time.monotonic() + timeout
    left = (max(0.0, deadline - time.monotonic()) for _ in pairs)
    unknown = ", ".join(topic for topic, given in pairs.items() if not given)
    with long_task(f"waiting for a publisher of {unknown}", timeout, at_most=True):
        return {topic: given or message_class(wait_for_type(node, topic, next(left))) for topic, given in pairs.items()}


def qos_for(topic: str, published: Sequence[TopicEndpointInfo]) -> QoSProfile:
    """A QoS profile with which a subscription receives from all publishers of a topic, known or expected."""
    best_effort = any(p.qos_profile.reliability == ReliabilityPolicy.BEST_EFFORT for p in published)
    latched = [p.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL for p in published]
    keeps = all(latched) if latched else topic in LATCHED
    return QoSProfile(
        depth=DEPTH,
        reliability=ReliabilityPolicy.BEST_EFFORT if best_effort else ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if keeps else DurabilityPolicy.VOLATILE,
    )
