"""`ros2 topic`: list, info, type, find here; echo, pub, hz, bw, delay in modules of their own."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Mapping, Sequence

from course_kit.ros2.completion import message_types, topic_names, topic_types_in_use
from course_kit.ros2.named import print_found, print_list, print_types
from course_kit.ros2.session import Session
from course_kit.ros2.topic.echo import ECHO
from course_kit.ros2.topic.pub import PUB
from course_kit.ros2.topic.rates import BW, DELAY, HZ
from course_kit.ros2.verbs import CommandError, Verb, add_strategy_arguments, did_you_mean


def add_arguments(parser: ArgumentParser) -> None:
    parser.add_argument("--include-hidden-topics", action="store_true", help="Consider hidden topics as well")


def _list_arguments(parser: ArgumentParser) -> None:
    add_strategy_arguments(parser)
    parser.add_argument("-t", "--show-types", action="store_true", help="Additionally show the topic type")
    parser.add_argument(
        "-c", "--count-topics", action="store_true", help="Only display the number of topics discovered"
    )
    parser.add_argument("--include-hidden-topics", action="store_true", help="Consider hidden topics as well")
    parser.add_argument("-v", "--verbose", action="store_true", help="List full details about each topic")


def _list(args: Namespace, session: Session) -> None:
    from course_kit.ros_graph import graph

    node = session.graph()
    topics = graph.topics(node, args.include_hidden_topics)
    if args.verbose and topics and not args.count_topics:
        session.print(counted("Published", "publisher", topics, {t: node.count_publishers(t) for t in topics}))
        session.print(counted("Subscribed", "subscriber", topics, {t: node.count_subscribers(t) for t in topics}))
    else:
        print_list(session, topics, args.count_topics, args.show_types)


def counted(heading: str, noun: str, topics: Mapping[str, Sequence[str]], counts: Mapping[str, int]) -> str:
    """The block of `list -v` for publishers or subscribers: topics that have any, and how many."""
    lines = [f"{heading} topics:"]
    for name, types in topics.items():
        if count := counts[name]:
            lines.append(f" * {name} [{', '.join(types)}] {count} {noun}{'s' if count > 1 else ''}")
    return "\n".join([*lines, ""])


def _info_arguments(parser: ArgumentParser) -> None:
    add_strategy_arguments(parser)
    argument = parser.add_argument("topic_name", help="Name of the ROS topic to get info (e.g. '/chatter')")
    argument.completer = topic_names  # type: ignore[attr-defined]
    parser.add_argument(
        "--verbose",
        "-v",
        action="store_true",
        help="Prints detailed information like the node name, node namespace, topic type, topic type hash, GUID, "
        "and QoS Profile of the publishers and subscribers to this topic",
    )


def _info(args: Namespace, session: Session) -> None:
    from course_kit.ros_graph import graph

    node = session.graph()
    topics = graph.topics(node, with_hidden=True)
    topic = args.topic_name
    if topic not in topics:
        raise CommandError(f"Unknown topic '{topic}'", did_you_mean(topic, topics))
    end = "\n\n" if args.verbose else "\n"
    types = topics[topic]
    session.print(f"Type: {types[0] if len(types) == 1 else types}", end=end)
    session.print(f"Publisher count: {node.count_publishers(topic)}", end=end)
    for endpoint in graph.publishers(node, topic) if args.verbose else ():
        session.print(str(endpoint), end=end)
    session.print(f"Subscription count: {node.count_subscribers(topic)}", end=end)
    for endpoint in graph.subscriptions(node, topic) if args.verbose else ():
        session.print(str(endpoint), end=end)


def _type_arguments(parser: ArgumentParser) -> None:
    add_strategy_arguments(parser)
    argument = parser.add_argument("topic_name", help="Name of the ROS topic to get type (e.g. '/chatter')")
    argument.completer = topic_names  # type: ignore[attr-defined]


def _type(args: Namespace, session: Session) -> int:
    from course_kit.ros_graph import graph

    return print_types(session, graph.topics(session.graph(), with_hidden=True).get(args.topic_name, []))


def _find_arguments(parser: ArgumentParser) -> None:
    add_strategy_arguments(parser)
    argument = parser.add_argument(
        "topic_type", help="Name of the ROS topic type to filter for (e.g. 'std_msgs/msg/String')"
    )
    argument.completer = topic_types_in_use  # type: ignore[attr-defined]
    parser.add_argument(
        "-c", "--count-topics", action="store_true", help="Only display the number of topics discovered"
    )
    parser.add_argument("--include-hidden-topics", action="store_true", help="Consider hidden topics as well")


def _find(args: Namespace, session: Session) -> None:
    from course_kit.ros_graph import graph

    topics = graph.topics(session.graph(), args.include_hidden_topics)
    print_found(session, topics, args.topic_type, args.count_topics, message_types())


VERBS = {
    "bw": BW,
    "delay": DELAY,
    "echo": ECHO,
    "find": Verb("Output a list of available topics of a given type", _find, _find_arguments),
    "hz": HZ,
    "info": Verb("Print information about a topic", _info, _info_arguments),
    "list": Verb("Output a list of available topics", _list, _list_arguments),
    "pub": PUB,
    "type": Verb("Print a topic's type", _type, _type_arguments),
}
