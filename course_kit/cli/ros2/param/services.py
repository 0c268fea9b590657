"""The parameter services of another node, called."""

from __future__ import annotations

from typing import Any

from course_kit.cli.ros2.session import Session
from course_kit.cli.ros2.verbs import failing

SERVICE_TIMEOUT = 5.0  # seconds given to a node's parameter service to be found, as in the real command
ANSWER_TIMEOUT = 10.0  # seconds given to the node to answer


def call(session: Session, node_name: str, service: str, **request: Any) -> Any:
    """The response of a node's parameter service, such as get_parameters. CommandError if the node does not answer."""
    from rcl_interfaces import srv  # type: ignore[import-untyped]

    from course_kit.ros.subscriptions import clients

    kind, name = getattr(srv, service.title().replace("_", "")), f"{node_name}/{service}"
    silence = (
        f"Exception while calling service of node '{node_name}': {name} gave no answer within {ANSWER_TIMEOUT:g} s. "
        "Is the node busy in a callback, or has it ended?"
    )
    with failing(LookupError, say=lambda _: "Wait for service timed out"), failing(TimeoutError, say=lambda _: silence):
        return clients.call(kind, name, kind.Request(**request), SERVICE_TIMEOUT, ANSWER_TIMEOUT, session.until)


def list_parameters(session: Session, node_name: str, *prefixes: str) -> list[str]:
    """The names of a node's parameters, sorted."""
    return sorted(call(session, node_name, "list_parameters", prefixes=prefixes).result.names)
