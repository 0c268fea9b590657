"""Clients that ask a service once: it finds the client, meets it, then answers.

A server that has not found a client yet throws its answers to that client away, and neither of them can see it.
"""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any

from rcl_interfaces.srv import GetParameters  # type: ignore[import-untyped]
from rclpy.client import Client
from rclpy.node import Node, NodeNameNonExistentError

from course_kit.base.polling import wait_until
from course_kit.ros.subscriptions import observer_node

MEET_TIMEOUT = 2.0  # seconds after which a server counts as busy
PERIOD = 0.5  # seconds from one request to the next while no answer comes
POLL = 0.002  # seconds between two looks at whether an answer has come
Until = Callable[[Callable[[], Any], float], Any]  # waits for a condition, in seconds; tells whether it holds
Wait = Callable[[Callable[[], Any], float, float], Any]  # the same with the seconds from one look to the next


@contextlib.contextmanager
def client_of(asking: Node, service_type: Any, name: str) -> Iterator[Client]:
    """A client while the block runs. It ends in the node's thread: what is destroyed while it is waited on raises."""
    client = asking.create_client(service_type, name)
    try:
        yield client
    finally:
        if asking.executor is not None:
            asking.executor.create_task(asking.destroy_client, client)


def call(
    service_type: Any, name: str, request: Any, found_timeout: float, timeout: float, wait: Wait = wait_until
) -> Any:
    """The response of a service. LookupError if nobody offers it in time, TimeoutError if no answer comes in time."""
    asking = observer_node.node()
    with client_of(asking, service_type, name) as client:
        if not wait(client.service_is_ready, found_timeout, POLL):
            raise LookupError(f"nobody offers {name} (waited {found_timeout:g} s)")
        late = time.monotonic() + timeout

        def until(condition: Callable[[], Any], seconds: float) -> Any:
            return wait(condition, max(0.0, min(seconds, late - time.monotonic())), POLL)

        meet_service(asking, client, until)
        future = client.call_async(request)
        if not until(future.done, timeout):
            raise TimeoutError(
                f"{name} gave no answer within {timeout:g} s. Is the node busy in a callback, or has it ended?"
            )
        return future.result()


def meet_server(client: Any, until: Until) -> bool:
    """Ask for the result of a goal that nobody has sent, until it is answered; False if the server is too busy for it.

    The server answers at once that it does not know the goal, and what a process makes is announced in order: so it
    knows what answers to a goal come to as well. The client is ready, and spins elsewhere.
    """
    from rclpy.action.client import ClientGoalHandle  # a service's client needs neither this nor numpy
    from unique_identifier_msgs.msg import UUID  # type: ignore[import-untyped]

    unknown = ClientGoalHandle(client, UUID(uuid=list(os.urandom(16))), None)
    return _is_answered(unknown.get_result_async, until)


def meet_service(node: Node, client: Client, until: Until) -> bool:
    """Ask the node that offers a service for no parameters, until it answers; False if it is too busy or has none.

    The client of the parameters is made after the service's, so a node that answers it knows both. The node with the
    client spins elsewhere.
    """
    if (name := _parameters_beside(node, node.resolve_service_name(client.srv_name))) is None:
        return False
    with client_of(node, GetParameters, name) as asking:
        is_ready = until(asking.service_is_ready, PERIOD)
        return bool(is_ready and _is_answered(lambda: asking.call_async(GetParameters.Request()), until))


def _parameters_beside(node: Node, service: str) -> str | None:
    """The service for parameters of the node that offers a service."""
    for name, namespace in node.get_node_names_and_namespaces():
        with suppress(NodeNameNonExistentError):  # it has ended meanwhile
            offered = {one for one, _ in node.get_service_names_and_types_by_node(name, namespace)}
            parameters = f"{namespace.rstrip('/')}/{name}/get_parameters"
            if {service, parameters} <= offered:
                return parameters
    return None


def _is_answered(ask: Callable[[], Any], until: Until) -> bool:
    answers: list[Any] = []
    for _ in range(round(MEET_TIMEOUT / PERIOD)):
        asked = time.monotonic()
        ask().add_done_callback(answers.append)
        if until(lambda: answers, PERIOD):
            return True
        if time.monotonic() < asked + PERIOD / 2:  # the caller's own time is over
            break
    return False
