"""What checks say about services: who serves, what is answered, and when; and servers of the checker's own."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from rclpy.task import Future

from course_kit.examining.examination import current
from course_kit.examining.introduction import meet
from course_kit.examining.station import Station
from course_kit.examining.vocabulary import arrival_timeout, expect_type, nearest, nobody_else, require, wait
from course_kit.internals.rmw_parts import service_topics
from course_kit.ros_graph.graph_data import EVERY_NODES_SERVICES

CONNECT_TIMEOUT = 5.0
ANSWER_TIMEOUT = 5.0  # seconds; what is lost on a busy machine is sent again within 3


def _services() -> dict[str, list[str]]:
    servers = [node.service_servers for node in current().stage.offered()]
    offered = {name: types for names in servers for name, types in names.items()}
    return {name: types for name, types in offered.items() if name.rpartition("/")[2] not in EVERY_NODES_SERVICES}


def expect_service(name: str, service_type: Any) -> Client:
    """The answer offers a service of this type; a client of it."""
    wait(lambda: name in _services(), arrival_timeout())
    services = _services()
    hint = f"Nobody serves `{name}`. {nearest(name, list(services))}"
    hint += f"Your node serves {', '.join(services)}. " if services else "Your node has no service of its own. "
    require(f"it serves `{name}`", name in services, f"{hint}`%ros2 service list -t` shows them.")
    hint = f" A client of another type waits for ever: `%ros2 service type {name}` shows it."
    expect_type(name, services[name], service_type, hint)
    return Client(name, service_type)


@dataclass
class Answer:
    """What came back from a call; `response` is None if nothing did."""

    response: Any
    seconds: float


class Client:
    """A client of the checker's, on the stage if not told otherwise."""

    def __init__(self, name: str, service_type: Any, station: Station | None = None) -> None:
        self._name, self._type = name, service_type
        nobody_else(*service_topics(name))
        station = station or current().stage
        self._client = station.check_node.create_client(service_type, name)
        wait(self._client.service_is_ready, CONNECT_TIMEOUT, f"the service {name}")
        meet(station, name)

    def ask(self, timeout: float = ANSWER_TIMEOUT, **request: Any) -> Answer:
        """Call, and wait for the response."""
        return self.ask_all(timeout, [request])[0]

    def ask_all(self, timeout: float, requests: list[dict[str, Any]]) -> list[Answer]:
        """Send several requests at once, and wait for all responses; without a server there are none."""
        if not self._client.service_is_ready():
            return [Answer(None, timeout) for _ in requests]
        began = time.monotonic()
        seconds: dict[Future, float] = {}  # of those that are answered
        futures = [self._client.call_async(self._type.Request(**request)) for request in requests]
        for future in futures:
            future.add_done_callback(lambda done: seconds.setdefault(done, time.monotonic() - began))
        wait(lambda: len(seconds) == len(futures), timeout, f"the response of {self._name}")
        answers = [Answer(f.result(), seconds[f]) if f in seconds else Answer(None, timeout) for f in futures]
        for future in futures:
            self._client.remove_pending_request(future)  # does nothing for those that are answered
        return answers


def no_answer(name: str, timeout: float = ANSWER_TIMEOUT) -> str:
    """The hint for a call that did not come back."""
    return (
        f"No response of `{name}` within {timeout:g} s. Does the callback return the response, on every way through "
        f'it? Does it wait for something that its own node must deliver? `logs(level="ERROR")` shows what it raised.'
    )


@dataclass
class Server:
    """A server of the checker's on the stage, which notes what it was asked and what it answered."""

    answer: Callable[[Any, Any], Any]
    delay: float = 0.0
    requests: list[Any] = field(default_factory=list)
    responses: list[Any] = field(default_factory=list)
    ended: threading.Event = field(default_factory=threading.Event)

    def serve(self, request: Any, response: Any) -> Any:
        """Answer a request as the exercise's server does."""
        self.requests.append(request)
        if self.delay:
            self.ended.wait(self.delay)
        answered = self.answer(request, response)
        self.responses.append(answered)
        return answered


def a_server(name: str, service_type: Any, answer: Callable[[Any, Any], Any]) -> Server:
    """Serve a service on the stage until the check ends."""
    nobody_else(*service_topics(name))
    server = Server(answer)
    current().stage.on_own_node(lambda node: node.create_service(service_type, name, server.serve))
    current().ending.callback(server.ended.set)  # what still waits in a callback would keep the node in the graph
    return server


def add_two_ints(request: Any, response: Any) -> Any:
    """What the chapter's server answers."""
    response.sum = request.a + request.b
    return response
