"""What Tab offers for the arguments of `ros2`: names from the graph, types from what is installed.

Each function is a completer of argcomplete: it takes the word begun and what was parsed so far. The shell and
`%ros2` use the same ones.
"""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterable
from functools import lru_cache
from typing import Any

from course_kit.ros2.session import Session


def _beginning(names: Iterable[str], prefix: str) -> list[str]:
    return [name for name in names if name.startswith(prefix)]


def topic_names(prefix: str, parsed_args: Namespace, **_: Any) -> list[str]:
    """Topics of the graph."""
    from course_kit.ros_graph import graph

    with_hidden = getattr(parsed_args, "include_hidden_topics", False)
    return _beginning(graph.topics(Session(parsed_args).graph(), with_hidden), prefix)


def service_names(prefix: str, parsed_args: Namespace, **_: Any) -> list[str]:
    """Services of the graph."""
    from course_kit.ros_graph import graph

    return _beginning(graph.services(Session(parsed_args).graph()), prefix)


def action_names(prefix: str, parsed_args: Namespace, **_: Any) -> list[str]:
    """Actions of the graph."""
    from course_kit.ros_graph import graph

    return _beginning(graph.actions(Session(parsed_args).graph()), prefix)


def node_names(prefix: str, parsed_args: Namespace, **_: Any) -> list[str]:
    """Nodes of the graph."""
    from course_kit.ros_graph import graph

    return _beginning((name.full_name for name in graph.nodes(Session(parsed_args).graph())), prefix)


def parameter_names(prefix: str, parsed_args: Namespace, **_: Any) -> list[str]:
    """Parameters of the node that was named before."""
    from course_kit.ros2.param.services import list_parameters

    session = Session(parsed_args)
    session.graph()
    return _beginning(list_parameters(session, parsed_args.node_name), prefix)


def topic_types_in_use(prefix: str, parsed_args: Namespace, **_: Any) -> list[str]:
    """Types of the topics of the graph."""
    from course_kit.ros_graph import graph

    topics = graph.topics(Session(parsed_args).graph(), with_hidden=True)
    return _beginning(sorted({t for types in topics.values() for t in types}), prefix)


def service_types_in_use(prefix: str, parsed_args: Namespace, **_: Any) -> list[str]:
    """Types of the services of the graph."""
    from course_kit.ros_graph import graph

    services = graph.services(Session(parsed_args).graph(), with_hidden=True)
    return _beginning(sorted({t for types in services.values() for t in types}), prefix)


def type_of_topic(prefix: str, parsed_args: Namespace, **_: Any) -> list[str]:
    """The type of the topic that was named before; every message type if nobody has it."""
    from course_kit.ros_graph import graph

    topic = getattr(parsed_args, "topic_name", "")
    types = graph.topics(Session(parsed_args).graph(), with_hidden=True).get(topic)
    return _beginning(types or message_types(), prefix)


def type_of_service(prefix: str, parsed_args: Namespace, **_: Any) -> list[str]:
    """The type of the service that was named before; every service type if nobody offers it."""
    from course_kit.ros_graph import graph

    service = getattr(parsed_args, "service_name", "")
    types = graph.services(Session(parsed_args).graph(), with_hidden=True).get(service)
    return _beginning(types or service_types(), prefix)


def type_of_action(prefix: str, parsed_args: Namespace, **_: Any) -> list[str]:
    """The type of the action that was named before; every action type if nobody offers it."""
    from course_kit.ros_graph import graph

    action = getattr(parsed_args, "action_name", "")
    types = graph.actions(Session(parsed_args).graph()).get(action)
    return _beginning(types or action_types(), prefix)


def message_types() -> tuple[str, ...]:
    """Every message type that is installed."""
    return _installed("msg")


def service_types() -> tuple[str, ...]:
    """Every service type that is installed."""
    return _installed("srv")


def action_types() -> tuple[str, ...]:
    """Every action type that is installed."""
    return _installed("action")


@lru_cache
def _installed(kind: str) -> tuple[str, ...]:
    from ament_index_python import get_resource, get_resources

    types = []
    for package in get_resources("rosidl_interfaces"):
        listing, _ = get_resource("rosidl_interfaces", package)
        names = {line.rsplit(".", 1)[0] for line in listing.split() if line.startswith(f"{kind}/")}
        types += [f"{package}/{name}" for name in names if "_" not in name]
    return tuple(sorted(types))
