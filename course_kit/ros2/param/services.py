"""The parameter services of another node, called."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

from course_kit.ros2.session import Session
from course_kit.ros2.verbs import failing

SERVICE_TIMEOUT = 5.0  # seconds given to a node's parameter service to be found, as in the real command
ANSWER_TIMEOUT = 10.0  # seconds given to the node to answer
REPEATED_AFTER = 3.0  # seconds: the answer is lost to a client that the node has not found yet, and neither can see it


def call(session: Session, node_name: str, service: str, is_repeated: bool = True, **request: Any) -> Any:
    """The response of a node's parameter service, such as get_parameters. CommandError if the node does not answer.

    Without an answer it asks once more, unless what is asked for cannot be done twice (not `is_repeated`).
    """
    from rcl_interfaces import srv  # type: ignore[import-untyped]

    from course_kit.watching.instruments import call as call_service

    kind, name = getattr(srv, service.title().replace("_", "")), f"{node_name}/{service}"

    def ask(timeout: float) -> Any:
        return call_service(kind, name, kind.Request(**request), SERVICE_TIMEOUT, timeout, session.until)

    silence = (
        f"Exception while calling service of node '{node_name}': {name} gave no answer within {ANSWER_TIMEOUT:g} s. "
        "Is the node busy in a callback, or has it ended?"
    )
    with failing(LookupError, say=lambda _: "Wait for service timed out"), failing(TimeoutError, say=lambda _: silence):
        if not is_repeated:
            return ask(ANSWER_TIMEOUT)
        with suppress(TimeoutError):
            return ask(REPEATED_AFTER)
        return ask(ANSWER_TIMEOUT - REPEATED_AFTER)


def list_parameters(session: Session, node_name: str, *prefixes: str) -> list[str]:
    """The names of a node's parameters, sorted."""
    return sorted(call(session, node_name, "list_parameters", prefixes=prefixes).result.names)
