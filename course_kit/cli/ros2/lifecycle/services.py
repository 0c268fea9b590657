"""The services that every lifecycle node has: who offers them, and a call of one of them."""

from __future__ import annotations

import math
import time
from typing import Any

from course_kit.cli.ros2.servers import outcome
from course_kit.cli.ros2.session import Session
from course_kit.cli.ros2.verbs import CommandError

FOUND_TIMEOUT = 5.0  # seconds given to a service to be found
ANSWER_TIMEOUT = 10.0  # seconds given to a node to say how it is
GET_STATE = "lifecycle_msgs/srv/GetState"
KINDS = {
    "change_state": "ChangeState",
    "get_available_transitions": "GetAvailableTransitions",
    "get_state": "GetState",
    "get_transition_graph": "GetAvailableTransitions",
}


def lifecycle_nodes(session: Session, with_hidden: bool) -> list[str]:
    """The full names of the nodes that have a lifecycle, sorted."""
    from course_kit.ros.graph import graph

    node = session.graph()
    offered = graph.services(node, with_hidden=True)
    names = dict.fromkeys(name.full_name for name in graph.nodes(node, with_hidden))
    return [name for name in names if GET_STATE in offered.get(f"{name}/get_state", ())]


def call(session: Session, node_name: str, service: str, timeout: float | None, **request: Any) -> Any:
    """The response of a lifecycle node's service, such as get_state. CommandError if none comes.

    Without a timeout a question has ANSWER_TIMEOUT, and a transition as long as the node's callback takes.
    """
    from lifecycle_msgs import srv  # type: ignore[import-untyped]

    from course_kit.ros.subscriptions.clients import client_of, meet_service

    kind, doing = getattr(srv, KINDS[service]), f"calling service of node '{node_name}'"
    if timeout is None:
        timeout = math.inf if service == "change_state" else ANSWER_TIMEOUT
    with client_of(session.node, kind, f"{node_name}/{service}") as client:
        if not session.until(client.service_is_ready, FOUND_TIMEOUT):
            raise CommandError(f"Exception while {doing}: nobody offers {node_name}/{service}")
        late = time.monotonic() + timeout
        meet_service(session.node, client, session.until)
        response = outcome(
            session,
            client.call_async(kind.Request(**request)),
            client.service_is_ready,
            doing,
            "it ended before it answered",
            stops=lambda: time.monotonic() > late,
        )
    if response is None:
        raise CommandError(
            f"Exception while {doing}: no answer within {timeout:g} s. Is it busy in a callback, or not spun?"
        )
    return response


def transitions(
    session: Session, node_name: str, timeout: float | None = None, of_all_states: bool = False
) -> list[Any]:
    """The lifecycle_msgs TransitionDescriptions of a node: those that it may make now, or those of all states."""
    service = "get_transition_graph" if of_all_states else "get_available_transitions"
    return list(call(session, node_name, service, timeout).available_transitions)
