"""`ros2 node`: list, info."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Mapping, Sequence
from dataclasses import fields

from course_kit.cli.ros2.completion import node_names
from course_kit.cli.ros2.session import Session
from course_kit.cli.ros2.verbs import GRAPH, CommandError, Verb, argument, did_you_mean, flag


def _list(args: Namespace, session: Session) -> None:
    from course_kit.ros.graph import graph

    names = graph.nodes(session.graph(), with_hidden=args.all)
    if args.count_nodes:
        session.print(str(len(names)))
        return
    if names:
        session.print("\n".join(name.full_name for name in names))
    if graph.duplicates(names):
        session.warn(
            "WARNING: Be aware that there are nodes in the graph that share an exact name, "
            "which can have unintended side effects."
        )


def block(heading: str, named: Mapping[str, Sequence[str]]) -> str:
    """One headed list of `node info`; a list without entries leaves an empty line, as the real command's does."""
    lines = [f"    {name}: {', '.join(types)}" for name, types in named.items()]
    return "\n".join([f"  {heading}:", *(lines or [""])])


def _info(args: Namespace, session: Session) -> None:
    from rclpy.node import NodeNameNonExistentError

    from course_kit.ros.graph import graph

    node = session.graph()
    known = [name.full_name for name in graph.nodes(node, with_hidden=args.include_hidden)]
    wanted = graph.NodeName.of(args.node_name).full_name
    count = known.count(wanted)
    suggestion = None if graph.is_hidden(wanted) else did_you_mean(wanted, known)
    unknown = CommandError(f"Unable to find node '{args.node_name}'", suggestion)
    if not count:
        raise unknown
    if count > 1:
        session.warn(
            f'There are {count} nodes in the graph with the exact name "{args.node_name}". '
            "You are seeing information about only one of them."
        )
    try:
        offered = graph.interfaces(node, graph.NodeName.of(wanted), args.include_hidden)
    except NodeNameNonExistentError:  # it ended this moment
        raise unknown from None
    blocks = [block(field.name.replace("_", " ").title(), getattr(offered, field.name)) for field in fields(offered)]
    session.print("\n".join([args.node_name, *blocks]))


VERBS = {
    "info": Verb(
        "show the publishers, subscriptions, services and actions of a node",
        _info,
        GRAPH,
        argument("node_name", "the node, such as /turtlesim", node_names),
        flag("--include-hidden", "include hidden ones, with an underscore in the name"),
    ),
    "list": Verb(
        "list the nodes",
        _list,
        GRAPH,
        flag("-a --all", "include hidden nodes, with an underscore in the name"),
        flag("-c --count-nodes", "print only the number"),
    ),
}
