"""`ros2 action`: list, type, info here; send_goal in a module of its own."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from course_kit.ros2.action.send_goal import SEND_GOAL
from course_kit.ros2.completion import action_names
from course_kit.ros2.named import names, print_list, print_types
from course_kit.ros2.session import Session
from course_kit.ros2.verbs import CommandError, Verb, add_strategy_arguments


def _list_arguments(parser: ArgumentParser) -> None:
    add_strategy_arguments(parser)
    parser.add_argument("-t", "--show-types", action="store_true", help="Additionally show the action type")
    parser.add_argument(
        "-c", "--count-actions", action="store_true", help="Only display the number of actions discovered"
    )


def _list(args: Namespace, session: Session) -> None:
    from course_kit.ros_graph import graph

    print_list(session, graph.actions(session.graph()), args.count_actions, args.show_types)


def _name_argument(parser: ArgumentParser, purpose: str) -> None:
    argument = parser.add_argument("action_name", help=f"Name of the ROS action to {purpose} (e.g. '/fibonacci')")
    argument.completer = action_names  # type: ignore[attr-defined]


def _info_arguments(parser: ArgumentParser) -> None:
    add_strategy_arguments(parser)
    _name_argument(parser, "get info")
    parser.add_argument("-t", "--show-types", action="store_true", help="Additionally show the action type")
    parser.add_argument(
        "-c", "--count", action="store_true", help="Only display the number of action clients and action servers"
    )


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


def _type_arguments(parser: ArgumentParser) -> None:
    add_strategy_arguments(parser)
    _name_argument(parser, "get type")


def _type(args: Namespace, session: Session) -> int:
    from course_kit.ros_graph import graph

    return print_types(session, graph.actions(session.graph()).get(args.action_name, []))


VERBS = {
    "info": Verb("Print information about an action", _info, _info_arguments),
    "list": Verb("Output a list of action names", _list, _list_arguments),
    "send_goal": SEND_GOAL,
    "type": Verb("Print a action's type", _type, _type_arguments),
}
