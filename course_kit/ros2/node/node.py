"""`ros2 node`: list, info."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Mapping, Sequence

from course_kit.ros2.completion import node_names
from course_kit.ros2.session import Session
from course_kit.ros2.verbs import CommandError, Verb, add_flag, add_offered, add_strategy_arguments, did_you_mean


def _list_arguments(parser: ArgumentParser) -> None:
    add_strategy_arguments(parser)
    add_flag(parser, "-a --all", "Display all nodes even hidden ones")
    add_flag(parser, "-c --count-nodes", "Only display the number of nodes discovered")


def _list(args: Namespace, session: Session) -> None:
    from course_kit.ros_graph import graph

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


def _info_arguments(parser: ArgumentParser) -> None:
    add_strategy_arguments(parser)
    add_offered(parser, "node_name", node_names, "Node name to request information")
    add_flag(parser, "--include-hidden", "Display hidden topics, services, and actions as well")


def block(heading: str, named: Mapping[str, Sequence[str]]) -> str:
    """One headed list of `node info`; a list without entries leaves an empty line, as the real command's does."""
    lines = [f"    {name}: {', '.join(types)}" for name, types in named.items()]
    return "\n".join([f"  {heading}:", *(lines or [""])])


def _info(args: Namespace, session: Session) -> None:
    from rclpy.node import NodeNameNonExistentError

    from course_kit.ros_graph import graph

    node = session.graph()
    known = [name.full_name for name in graph.nodes(node, with_hidden=True)]
    wanted = graph.NodeName.of(args.node_name).full_name
    count = known.count(wanted)
    unknown = CommandError(f"Unable to find node '{args.node_name}'", did_you_mean(wanted, known))
    if not count:
        raise unknown
    if count > 1:
        session.warn(
            f"There are {count} nodes in the graph with the exact name '{args.node_name}'. "
            "You are seeing information about only one of them."
        )
    try:
        offered = graph.interfaces(node, graph.NodeName.of(wanted), args.include_hidden)
    except NodeNameNonExistentError:  # it ended this moment
        raise unknown from None
    blocks = {
        "Subscribers": offered.subscribers,
        "Publishers": offered.publishers,
        "Service Servers": offered.service_servers,
        "Service Clients": offered.service_clients,
        "Action Servers": offered.action_servers,
        "Action Clients": offered.action_clients,
    }
    session.print("\n".join([args.node_name, *(block(heading, named) for heading, named in blocks.items())]))


VERBS = {
    "info": Verb("Output information about a node", _info, _info_arguments),
    "list": Verb("Output a list of available nodes", _list, _list_arguments),
}
