"""Calls a service again as its recorded events say that it was called."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from typing import Any

from rclpy.serialization import deserialize_message
from service_msgs.msg import ServiceEventInfo

from course_kit.base.polling import wait_until
from course_kit.ros.interface_types import message_class
from course_kit.ros.subscriptions import observer_node
from course_kit.ros.subscriptions.clients import client_of

REQUESTS = (ServiceEventInfo.REQUEST_SENT, ServiceEventInfo.REQUEST_RECEIVED)
ANSWER_TIMEOUT = 1.0  # seconds given to the last answers


class Requests:
    """The client of one service. `say` gets a line for each kind of request that cannot be sent, once.

    Raises ValueError or ImportError if the type, that of its events, is not installed.
    """

    def __init__(self, name: str, event_type: str, say: Callable[[str], None]) -> None:
        self.name, self._say = name, say
        self._event = message_class(event_type)
        self._stack = ExitStack()
        service = message_class(event_type.removesuffix("_Event"))
        self._client = self._stack.enter_context(client_of(observer_node.node(), service, name))
        self._sources: dict[bytes, int] = {}  # by client: who tells of its requests, itself or the server
        self._answers: list[Any] = []
        self._said: set[str] = set()

    @property
    def is_matched(self) -> bool:
        """True if the server, if there is one, is connected."""
        return self._client.service_is_ready() or not observer_node.node().count_services(self.name)

    def publish(self, data: bytes) -> None:
        """Send the request of a serialised event, unless it is an event of another kind."""
        event = deserialize_message(data, self._event)
        info = event.info
        if info.event_type not in REQUESTS:
            return
        if not event.request:
            self._say_once(f"The events of {self.name} have no requests in them: its introspection was on metadata.")
        elif not self._client.service_is_ready():
            self._say_once(f"Nobody offers {self.name}: its requests are not sent.")
        elif self._sources.setdefault(bytes(bytearray(info.client_gid)), info.event_type) == info.event_type:
            self._answers = [answer for answer in self._answers if not answer.done()]
            self._answers.append(self._client.call_async(event.request[0]))

    def _say_once(self, text: str) -> None:
        if text not in self._said:
            self._said.add(text)
            self._say(text)

    def wait_for_answers(self) -> None:
        """Wait until all is answered: a request is lost if its client goes before it is taken."""
        wait_until(lambda: all(answer.done() for answer in self._answers), ANSWER_TIMEOUT)

    def close(self) -> None:
        """End the client."""
        self._stack.close()
