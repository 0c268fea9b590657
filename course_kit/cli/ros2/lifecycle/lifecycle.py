"""`ros2 lifecycle`: get, list, nodes, set."""

from __future__ import annotations

from argparse import Namespace

from course_kit.cli.ros2.completion import offering
from course_kit.cli.ros2.lifecycle.services import call, lifecycle_nodes, transitions
from course_kit.cli.ros2.session import Session
from course_kit.cli.ros2.verbs import GRAPH, CommandError, Verb, argument, flag, positive_float


def _found_node(args: Namespace, session: Session) -> str:
    """The full name of the lifecycle node that was named."""
    from course_kit.ros.graph import graph

    wanted = graph.NodeName.of(args.node_name).full_name
    if wanted in lifecycle_nodes(session, args.include_hidden_nodes):
        return wanted
    others = {name.full_name for name in graph.nodes(session.node)} - set(lifecycle_nodes(session, with_hidden=True))
    raise CommandError("Node not found", f"{wanted} is a node without a lifecycle" if wanted in others else None)


def _nodes(args: Namespace, session: Session) -> None:
    names = lifecycle_nodes(session, args.all)
    if args.count_nodes or names:
        session.print(str(len(names)) if args.count_nodes else "\n".join(names))


def _get(args: Namespace, session: Session) -> None:
    if args.node_name is not None:
        session.print(_state(session, _found_node(args, session), args.timeout))
        return
    for name in lifecycle_nodes(session, args.include_hidden_nodes):
        try:
            session.print(f"{name}: {_state(session, name, args.timeout)}")
        except CommandError as error:  # one node that does not answer must not hide the others
            session.warn(str(error))


def _state(session: Session, node_name: str, timeout: float | None) -> str:
    state = call(session, node_name, "get_state", timeout).current_state
    return f"{state.label} [{state.id}]"


def _list(args: Namespace, session: Session) -> None:
    for one in transitions(session, _found_node(args, session), args.timeout, of_all_states=args.all):
        session.print(f"- {one.transition.label} [{one.transition.id}]")
        session.print(f"\tStart: {one.start_state.label}\n\tGoal: {one.goal_state.label}")


def _set(args: Namespace, session: Session) -> None:
    node = _found_node(args, session)
    offered = [one.transition for one in transitions(session, node, args.timeout)]
    by_label = [one for one in offered if one.label == args.transition]
    chosen = [*by_label, *(one for one in offered if str(one.id) == args.transition)][:1]
    if not chosen:
        known = "".join(f"\n- {one.label} [{one.id}]" for one in offered)
        raise CommandError(f"Unknown transition requested, available ones are:{known}")
    if call(session, node, "change_state", args.timeout, transition=chosen[0]).success:
        session.print("Transitioning successful")
    else:
        session.warn("Transitioning failed")


@offering
def _names(args: Namespace) -> list[str]:
    """Offers the lifecycle nodes of the graph."""
    return lifecycle_nodes(Session(args), args.include_hidden_nodes)


@offering
def _labels(args: Namespace) -> list[str]:
    """Offers the transitions that the node has now."""
    session = Session(args)
    return [one.transition.label for one in transitions(session, _found_node(args, session))]


_HIDDEN = "also nodes that are hidden, by an underscore in the name"
_INCLUDE_HIDDEN = flag("--include-hidden-nodes", _HIDDEN)
_TIMEOUT = argument("--timeout", "wait at most N seconds for an answer", metavar="N", type=positive_float)
_NODE = argument("node_name", "the node, such as /lc_talker", _names)
VERBS = {
    "get": Verb(
        "show the state of a lifecycle node, or of all",
        _get,
        GRAPH,
        argument("node_name", "the node (default: all)", _names, nargs="?"),
        flag("--include-hidden-nodes -a --all", _HIDDEN),
        _TIMEOUT,
    ),
    "list": Verb(
        "list the transitions that a node may make now",
        _list,
        GRAPH,
        _NODE,
        _INCLUDE_HIDDEN,
        _TIMEOUT,
        flag("-a --all", "list the transitions of every state"),
    ),
    "nodes": Verb(
        "list the lifecycle nodes",
        _nodes,
        GRAPH,
        flag("-a --all", _HIDDEN),
        flag("-c --count-nodes", "print only the number"),
    ),
    "set": Verb(
        "make a node do a transition",
        _set,
        GRAPH,
        _NODE,
        _INCLUDE_HIDDEN,
        _TIMEOUT,
        argument("transition", "its name or number, such as configure", _labels),
    ),
}
