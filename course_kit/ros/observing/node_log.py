"""The log of the student's nodes, by the publisher of each line.

Names do not tell a node from the one of the same name that ran before it, and times do so only where both are seen to
come and go. Each node has a publisher of its own for /rosout, and each line comes with the publisher's id.
"""

from __future__ import annotations

import itertools
import threading
import time
from collections import deque
from collections.abc import Collection
from typing import Any, NamedTuple

from rcl_interfaces.msg import Log
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import deserialize_message

from course_kit.ros.private_api import NotAsExpected
from course_kit.ros.private_api.rmw_parts import SerializedSubscription, is_fast_dds

TOPIC = "rt/rosout"  # /rosout, as the middleware spells it
DEPTH = 10_000
KEPT = 20_000  # lines
FIRST = 200  # lines of each node that are kept besides, however much is logged after them


class Line(NamedTuple):
    """One line: when it was received (nanoseconds), its publisher's id, and the message."""

    received: int
    publisher: bytes
    message: Any


class NodeLog:
    """The first lines of each node and the last 20,000, also those logged shortly before. close() it in the end."""

    def __init__(self, node: Node) -> None:
        self._first: dict[bytes, list[Line]] = {}  # by publisher
        self._lines: deque[Line] = deque(maxlen=KEPT)
        self._lock = threading.Lock()
        # Cyclone DDS calls the sender of a message otherwise than the endpoint in the graph: there the name must do.
        self._by_name = not is_fast_dds()
        self._subscription: SerializedSubscription | None = None
        try:
            self._subscription = SerializedSubscription(node, TOPIC, "rcl_interfaces", "Log", DEPTH)
        except NotAsExpected:  # rclpy does not tell the publisher
            self._by_name = True
            qos = QoSProfile(depth=DEPTH, durability=DurabilityPolicy.TRANSIENT_LOCAL)
            node.create_subscription(Log, "/rosout", self._keep, qos)

    def _keep(self, message: Log) -> None:
        with self._lock:
            self._note(Line(time.time_ns(), b"", message))

    def _note(self, line: Line) -> None:
        first = self._first.setdefault(line.publisher, [])
        (first if len(first) < FIRST else self._lines).append(line)

    def take(self) -> None:
        """Take what has come."""
        with self._lock:
            while self._subscription is not None and (sample := self._subscription.take()) is not None:
                message = deserialize_message(sample.data, Log)
                self._note(Line(sample.received, sample.publisher, message))

    def lines(self, logger: str) -> list[Line]:
        """What came under the name of a logger or of a child of it so far."""
        self.take()
        with self._lock:
            kept = itertools.chain(*self._first.values(), self._lines)
            lines = [line for line in kept if f"{line.message.name}.".startswith(f"{logger}.")]
        return sorted(lines, key=lambda line: line.received)

    def lines_by(self, publishers: Collection[bytes], logger: str) -> list[Line]:
        """The lines of a logger and its children that came from these publishers."""
        return [line for line in self.lines(logger) if self._by_name or line.publisher in publishers]

    def said_by(self, publishers: Collection[bytes], logger: str) -> list[Any]:
        """The messages of these lines."""
        return [line.message for line in self.lines_by(publishers, logger)]

    def close(self) -> None:
        """End the subscription; before the node is destroyed."""
        with self._lock:
            if self._subscription is not None:
                self._subscription.close()
