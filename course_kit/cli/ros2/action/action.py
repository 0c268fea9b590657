"""`ros2 action`: list, type, info here; send_goal in a module of its own."""

from __future__ import annotations

from argparse import Namespace

from course_kit.cli.ros2.named import ACTIONS, names
from course_kit.cli.ros2.session import Session
from course_kit.cli.ros2.verbs import GRAPH, Verb, failing, flag


def _info(args: Namespace, session: Session) -> None:
    from rclpy.exceptions import InvalidTopicNameException
    from rclpy.expand_topic_name import expand_topic_name
    from rclpy.validate_full_topic_name import validate_full_topic_name

    from course_kit.cli.ros2.messages.arguments import checked_name
    from course_kit.ros.graph import graph

    node, name = session.graph(), checked_name(args.action_name, "action")
    with failing(InvalidTopicNameException, ValueError):
        name = expand_topic_name(name, node.get_name(), "/")
        validate_full_topic_name(name)
    clients, servers = graph.action_clients_and_servers(node, name)
    session.print(f"Action: {args.action_name}")
    for heading, found in (("Action clients", clients), ("Action servers", servers)):
        session.print(f"{heading}: {len(found)}")
        if found and not args.count:
            session.print("\n".join(f"    {line}" for line in names(dict(found), args.show_types)))


_SHARED = ACTIONS.verbs()
VERBS: dict[str, Verb | str] = {
    "info": Verb(
        "show who uses an action and who offers it",
        _info,
        GRAPH,
        ACTIONS.name,
        flag("-t --show-types", "show their types"),
        flag("-c --count", "print only the number"),
    ),
    "list": _SHARED["list"],
    "send_goal": "action.send_goal:SEND_GOAL",
    "type": _SHARED["type"],
}
