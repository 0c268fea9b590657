"""`ros2 topic`: list, info, type, find here; echo, pub, hz, bw, delay in modules of their own."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Callable, Mapping, Sequence

from course_kit.cli.ros2.named import TOPICS
from course_kit.cli.ros2.session import Session
from course_kit.cli.ros2.verbs import GRAPH, Verb, flag

add_arguments = TOPICS.hidden
_SHARED = TOPICS.verbs()


def _list(args: Namespace, session: Session) -> None:
    if not args.verbose or args.count_topics:
        TOPICS.list(args, session)
    elif topics := session.named("topic"):
        session.print(counted("Published", "publisher", topics, session.node.count_publishers))
        session.print(counted("Subscribed", "subscriber", topics, session.node.count_subscribers))


def counted(heading: str, noun: str, topics: Mapping[str, Sequence[str]], count_of: Callable[[str], int]) -> str:
    """The block of `list -v` for publishers or subscribers: topics that have any, and how many."""
    lines = [f"{heading} topics:"]
    for name, types in topics.items():
        if count := count_of(name):
            lines.append(f" * {name} [{', '.join(types)}] {count} {noun}{'s' if count > 1 else ''}")
    return "\n".join([*lines, ""])


def _info(args: Namespace, session: Session) -> None:
    from course_kit.ros.graph import graph

    topic, node, end = args.topic_name, session.graph(), "\n\n" if args.verbose else "\n"
    session.print(TOPICS.type_line(topic, graph.topics(node, with_hidden=True)), end=end)
    for heading, count, endpoints in (
        ("Publisher", node.count_publishers, graph.publishers),
        ("Subscription", node.count_subscribers, graph.subscriptions),
    ):
        session.print(f"{heading} count: {count(topic)}", end=end)
        for endpoint in endpoints(node, topic) if args.verbose else ():
            session.print(str(endpoint), end=end)


VERBS: dict[str, Verb | str] = {
    **_SHARED,
    "bw": "topic.hz_bw_delay:BW",
    "delay": "topic.hz_bw_delay:DELAY",
    "echo": "topic.echo:ECHO",
    "hz": "topic.hz_bw_delay:HZ",
    "info": Verb(
        "show the type of a topic, and the number of its publishers and subscriptions",
        _info,
        GRAPH,
        TOPICS.name,
        flag("--verbose -v", "show node, type and QoS of each endpoint"),
    ),
    "list": Verb(
        _SHARED["list"].summary,
        _list,
        _SHARED["list"].arguments,
        flag("-v --verbose", "count publishers and subscriptions"),
    ),
    "pub": "topic.pub:PUB",
}
