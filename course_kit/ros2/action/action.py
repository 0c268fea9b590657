"""`ros2 action`: list, type, info here; send_goal in a module of its own."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from course_kit.ros2.action.send_goal import SEND_GOAL
from course_kit.ros2.named import Named, names
from course_kit.ros2.session import Session
from course_kit.ros2.verbs import CommandError, Verb, add_flag, add_strategy_arguments

ACTIONS = Named("action", "/fibonacci", can_hide=False)


def _info_arguments(parser: ArgumentParser) -> None:
    add_strategy_arguments(parser)
    ACTIONS.add_name(parser, "get info")
    add_flag(parser, "-t --show-types", "Additionally show the action type")
    add_flag(parser, "-c --count", "Only display the number of action clients and action servers")


def _info(args: Namespace, session: Session) -> None:
    from rclpy.exceptions import InvalidTopicNameException
    from rclpy.expand_topic_name import expand_topic_name
    from rclpy.validate_full_topic_name import validate_full_topic_name

    from course_kit.ros_graph import graph

    node = session.graph()
    try:
        name = expand_topic_name(args.action_name, node.get_name(), "/")
        validate_full_topic_name(name)
    except (InvalidTopicNameException, ValueError) as error:
        raise CommandError(str(error)) from None
    clients, servers = graph.action_clients_and_servers(node, name)
    session.print(f"Action: {args.action_name}")
    for heading, found in (("Action clients", clients), ("Action servers", servers)):
        session.print(f"{heading}: {len(found)}")
        if found and not args.count:
            session.print("\n".join(f"    {line}" for line in names(dict(found), args.show_types)))


VERBS = {
    "info": Verb("Print information about an action", _info, _info_arguments),
    "list": Verb("Output a list of action names", ACTIONS.list, ACTIONS.list_arguments),
    "send_goal": SEND_GOAL,
    "type": Verb("Print a action's type", ACTIONS.type, ACTIONS.type_arguments),
}
