"""`ros2 topic echo`: the messages of a topic as text.

Messages are taken serialised, in the thread that watches, and decoded here as they are printed. If printing is slower
than the topic, the oldest of those that wait are left out.
"""

from __future__ import annotations

import math
import time
from argparse import Namespace
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from queue import Empty, SimpleQueue
from typing import Any

from course_kit.cli.ros2.messages.shown import SHOWN, shown
from course_kit.cli.ros2.named import TOPICS
from course_kit.cli.ros2.session import Session
from course_kit.cli.ros2.topic import endpoints
from course_kit.cli.ros2.verbs import GRAPH, Verb, argument, duration, failing, flag, positive_float
from course_kit.ros.private_api.import_parts import arrays_later

WAITING = 1000  # messages that may wait to be printed
TICK = 0.02  # seconds without a message after which other things are looked at


def _run(args: Namespace, session: Session) -> None:
    from course_kit.cli.ros2.topic.echo_text import expression, message_text, selector

    if args.lost_messages:
        session.warn("WARNING: '--lost-messages' is deprecated; lost messages are reported by default")
    select = selector(args.field)
    matches = expression(args.filter_expr) if args.filter_expr else lambda message: True
    kept = shown(args)
    topic = endpoints.full_name(args.topic_name)
    kind = _message_class(session, args)

    from rclpy.serialization import deserialize_message

    with _messages(session, args, topic, kind) as arrivals:
        ends = time.monotonic() + (args.timeout or math.inf)
        while time.monotonic() < ends:
            for data, info in session.items(arrivals.queue, timeout=TICK):
                arrivals.report(session, not args.no_lost_messages)
                message = select(data if args.raw else deserialize_message(data, kind))
                if matches(message):
                    about = info if args.include_message_info else None
                    session.print(message_text(message, about, kept, args.csv, args.flow_style), end="")
                    if args.once:
                        return
                if time.monotonic() >= ends:
                    return
            arrivals.report(session, not args.no_lost_messages)


def _message_class(session: Session, args: Namespace) -> Any:
    from course_kit.cli.ros2.messages.arguments import interface_class
    from course_kit.ros.subscriptions import topics

    if args.message_type is not None:
        kind = interface_class(args.message_type, "msg")
        session.graph()
        return kind
    name = endpoints.type_of(session, args.topic_name, waits=False)
    with arrays_later(), failing(ImportError, ValueError, say=lambda _: f"The message type '{name}' is invalid"):
        return topics.message_class(name)


@dataclass
class Arrivals:
    """What callbacks leave for the main thread: messages, and news about the subscription."""

    queue: SimpleQueue[tuple[bytes, dict[str, Any]]] = field(default_factory=SimpleQueue)
    warnings: SimpleQueue[str] = field(default_factory=SimpleQueue)
    lost: Callable[[], int] = lambda: 0
    reported: int = 0

    def put(self, data: bytes, info: dict[str, Any]) -> None:
        """Keep a message; the oldest goes if too many wait."""
        if self.queue.qsize() >= WAITING:
            with suppress(Empty):
                self.queue.get_nowait()
        self.queue.put((data, info))

    def report(self, session: Session, with_lost: bool) -> None:
        """Print the warnings, and what was lost since the last report."""
        session.warn_of(self.warnings)
        total = self.lost()
        if with_lost and total > self.reported:
            from course_kit.cli.ros2.topic.echo_text import lost_text

            session.print(lost_text(total - self.reported, total), end="")
        self.reported = total


@contextmanager
def _messages(session: Session, args: Namespace, topic: str, kind: Any) -> Iterator[Arrivals]:
    """The messages of a topic while the block runs.

    With a QoS on the command line it is that one, exactly, and a line says so if it fits no publisher.
    """
    from course_kit.ros.subscriptions import observer_node, topics

    arrivals, node = Arrivals(), session.node

    def note_mismatch(policy: Any) -> None:
        arrivals.warnings.put(endpoints.incompatible(node.get_name(), topic, policy, is_publisher=False))

    if endpoints.is_chosen(args):
        qos = endpoints.chosen(args)
        with endpoints.refused(topic):
            subscription = observer_node.subscribe_exactly(topic, arrivals.put, kind, qos, note_mismatch)
    else:
        for line in endpoints.mixed_offers(topics.publishers(node, topic)):
            session.print(line)
        with failing(TypeError, ValueError, RuntimeError):
            subscription = observer_node.subscribe(topic, arrivals.put, kind)
    arrivals.lost = lambda: subscription.lost
    try:
        yield arrivals
    finally:
        subscription.close(wait=False)


ECHO = Verb(
    "print the messages of a topic",
    _run,
    GRAPH,
    TOPICS.name,
    TOPICS.typed("message_type", nargs="?"),
    endpoints.qos_options("sensor_data"),
    flag("--csv", "print the values separated by commas; with -i the four values of the message info come first"),
    argument("--field", "print only this part of the message, such as pose.position or ranges[0]"),
    SHOWN,
    flag("--lost-messages", "ignored: lost messages are reported by default"),
    flag("--no-lost-messages", "do not report lost messages"),
    flag("--raw", "print the serialized bytes"),
    argument("--filter", "print only messages m for which this Python expression is true", dest="filter_expr"),
    flag("--once", "end after the first message"),
    argument("--timeout", "end after N seconds", metavar="N", type=positive_float),
    flag("--include-message-info -i", "print the times at which each message was sent and received"),
    duration,
)
