"""`ros2 topic`: list, info, type, find here; echo, pub, hz, bw, delay in modules of their own."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Mapping, Sequence

from course_kit.ros2.named import Named
from course_kit.ros2.session import Session
from course_kit.ros2.topic.echo import ECHO
from course_kit.ros2.topic.pub import PUB
from course_kit.ros2.topic.rates import BW, DELAY, HZ
from course_kit.ros2.verbs import CommandError, Verb, add_flag, add_strategy_arguments, did_you_mean

TOPICS = Named("topic", "/chatter", "std_msgs/msg/String")
add_arguments = TOPICS.add_hidden


def _list_arguments(parser: ArgumentParser) -> None:
    TOPICS.list_arguments(parser)
    add_flag(parser, "-v --verbose", "List full details about each topic")


def _list(args: Namespace, session: Session) -> None:
    topics = TOPICS.found(args, session)
    if not args.verbose or args.count_topics or not topics:
        TOPICS.show(topics, args, session, args.show_types)
        return
    node = session.node
    session.print(counted("Published", "publisher", topics, {t: node.count_publishers(t) for t in topics}))
    session.print(counted("Subscribed", "subscriber", topics, {t: node.count_subscribers(t) for t in topics}))


def counted(heading: str, noun: str, topics: Mapping[str, Sequence[str]], counts: Mapping[str, int]) -> str:
    """The block of `list -v` for publishers or subscribers: topics that have any, and how many."""
    lines = [f"{heading} topics:"]
    for name, types in topics.items():
        if count := counts[name]:
            lines.append(f" * {name} [{', '.join(types)}] {count} {noun}{'s' if count > 1 else ''}")
    return "\n".join([*lines, ""])


def _info_arguments(parser: ArgumentParser) -> None:
    add_strategy_arguments(parser)
    TOPICS.add_name(parser, "get info")
    details = (
        "Prints detailed information like the node name, node namespace, topic type, topic type hash, GUID, and QoS "
        "Profile of the publishers and subscribers to this topic"
    )
    add_flag(parser, "--verbose -v", details)


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


VERBS = {
    "bw": BW,
    "delay": DELAY,
    "echo": ECHO,
    "find": Verb("Output a list of available topics of a given type", TOPICS.find, TOPICS.find_arguments),
    "hz": HZ,
    "info": Verb("Print information about a topic", _info, _info_arguments),
    "list": Verb("Output a list of available topics", _list, _list_arguments),
    "pub": PUB,
    "type": Verb("Print a topic's type", TOPICS.type, TOPICS.type_arguments),
}
