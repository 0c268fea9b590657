"""Assertions about services: servers, answers, times; and servers and clients of the checker's own."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from rclpy.node import Node
from rclpy.task import Future

from course_kit.exercises.checker.assertions import arrival_timeout, expect_type, nearest, nobody_else, require, wait
from course_kit.exercises.checker.examination import current
from course_kit.exercises.checker.wait_for_discovery import meet
from course_kit.ros.graph.snapshot import EVERY_NODES_SERVICES
from course_kit.ros.observing.domain_observer import DomainObserver
from course_kit.ros.private_api.rmw_parts import service_topics

CONNECT_TIMEOUT = 5.0
ANSWER_TIMEOUT = 5.0  # seconds; what is lost on a busy machine is sent again within 3


def _services() -> dict[str, list[str]]:
    servers = [node.service_servers for node in current().test_domain.offered()]
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


@dataclass(eq=False)
class Answer:
    """What comes back from a call; `response` is None as long as nothing has."""

    response: Any = None
    seconds: float = 0.0  # from the request to the response, or to the end of the wait for it
    seen: Any = None  # what there was to see when the response came
    give_up: Callable[[], None] = lambda: None


class Client:
    """A client of the checker's, in the test domain if not told otherwise."""

    def __init__(self, name: str, service_type: Any, observer: DomainObserver | None = None) -> None:
        self._name, self._type = name, service_type
        nobody_else(*service_topics(name))
        observer = observer or current().test_domain
        self._client = observer.check_node.create_client(service_type, name)
        wait(self._client.service_is_ready, CONNECT_TIMEOUT, f"the service {name}")
        meet(observer, name)

    def ask(self, timeout: float = ANSWER_TIMEOUT, **request: Any) -> Answer:
        """Call, and wait for the response; without a server there is none."""
        if not self._client.service_is_ready():
            return Answer(seconds=timeout)
        return wait_for_answers(timeout, self.send(**request))[0]

    def send(self, look: Callable[[], Any] = lambda: None, /, **request: Any) -> Answer:
        """Call, and do not wait; what `look` gives when the response comes is noted with it."""
        answer, began = Answer(), time.monotonic()

        def note(done: Future) -> None:
            answer.seconds, answer.seen = time.monotonic() - began, look()
            answer.response = done.result()

        def give_up() -> None:
            answer.seconds = time.monotonic() - began
            self._client.remove_pending_request(future)

        future = self._client.call_async(self._type.Request(**request))
        future.add_done_callback(note)
        answer.give_up = give_up
        return answer


def wait_for_answers(timeout: float, *answers: Answer) -> tuple[Answer, ...]:
    """Wait until all of them have come or the time is over, and no longer for those that have not."""
    wait(lambda: all(each.response is not None for each in answers), timeout, "a response")
    for each in answers:
        if each.response is None:
            each.give_up()
    return answers


def no_answer(name: str, timeout: float = ANSWER_TIMEOUT) -> str:
    """The hint for a call that did not come back."""
    return (
        f"No response of `{name}` within {timeout:g} s. Does the callback return the response, on every way through "
        f'it? Does it wait for something that its own node must deliver? `logs(level="ERROR")` shows what it raised.'
    )


def callback_group(service: str) -> str | None:
    """The kind of callback group that a service of the answer's node is in, for a hint; None if that is not known."""
    return current().order("group", service=service).get("value")


class Server:
    """A server of the checker's in the test domain, which notes what it was asked and what it answered.

    It may be slow, be silent until it is told to go on, leave, and come back.
    """

    def __init__(self, name: str, service_type: Any, answer: Callable[[Any, Any], Any]) -> None:
        self._name, self._type, self._answer = name, service_type, answer
        self.delay = 0.0  # seconds before each answer
        self.requests: list[Any] = []
        self.responses: list[Any] = []
        self._go_on = threading.Event()
        self._service: Any = None
        self._node: Any = current().test_domain.on_own_node(self._serve)

    def _serve(self, node: Node) -> Node:
        self._service = node.create_service(self._type, self._name, self._on_request)
        return node

    def _on_request(self, request: Any, response: Any) -> Any:
        self.requests.append(request)
        self._go_on.clear()
        if self.delay:
            self._go_on.wait(self.delay)
        answered = self._answer(request, response)
        self.responses.append(answered)
        return answered

    def go_on(self, delay: float = 0.0) -> None:
        """Answer now what still waits, and with this delay what comes then."""
        self.delay = delay
        self._go_on.set()

    def leave(self) -> None:
        """Serve no longer."""
        self.go_on()
        self._in_its_thread(lambda: self._node.destroy_service(self._service))

    def come_back(self) -> None:
        """Serve again."""
        self._in_its_thread(lambda: self._serve(self._node))

    def _in_its_thread(self, do: Callable[[], object]) -> None:
        self._node.executor.create_task(do)


def a_server(name: str, service_type: Any, answer: Callable[[Any, Any], Any]) -> Server:
    """Serve a service in the test domain until the check ends."""
    nobody_else(*service_topics(name))
    server = Server(name, service_type, answer)
    current().ending.callback(server.go_on)  # what still waits in a callback would keep the node in the graph
    return server


def later(seconds: float, do: Callable[[], object]) -> None:
    """Have something done in so many seconds, while the check goes on; not after its end."""
    timer = threading.Timer(seconds, do)
    current().ending.callback(timer.cancel)
    timer.start()


class Adder:
    """What the chapter's server answers; and `too_much` more, by which one knows who has added."""

    too_much = 0

    def __call__(self, request: Any, response: Any) -> Any:
        """Answer the sum, as an int64 goes over."""
        total = request.a + request.b + self.too_much
        response.sum = (total + 2**63) % 2**64 - 2**63
        return response
