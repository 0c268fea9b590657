"""`ros2 topic echo`: the messages of a topic as text.

Messages are taken serialised, in the thread that watches, and decoded here as they are printed. If printing is slower
than the topic, the oldest of those that wait are left out.
"""

from __future__ import annotations

import time
from argparse import ArgumentParser, ArgumentTypeError, Namespace
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from queue import Empty, SimpleQueue
from typing import Any

from course_kit.ros2.completion import names_of, type_of
from course_kit.ros2.session import Session
from course_kit.ros2.topic import endpoints
from course_kit.ros2.verbs import (
    CommandError,
    Verb,
    add_duration_argument,
    add_flag,
    add_offered,
    add_strategy_arguments,
    did_you_mean,
)

TRUNCATE_LENGTH = 128
WAITING = 1000  # messages that may wait to be printed
TICK = 0.02  # seconds without a message after which other things are looked at


def unsigned_int(text: str) -> int:
    """A type of argparse, with the real command's message."""
    if not text.isdigit():
        raise ArgumentTypeError("value must be non-negative integer")
    return int(text)


def _arguments(parser: ArgumentParser) -> None:
    add_strategy_arguments(parser)
    add_offered(parser, "topic_name", names_of("topic"), "Name of the ROS topic to listen to (e.g. '/chatter')")
    add_offered(
        parser, "message_type", type_of("topic"), "Type of the ROS message (e.g. 'std_msgs/msg/String')", nargs="?"
    )
    endpoints.add_qos_arguments(parser, "subscribe", "sensor_data")
    add_flag(
        parser,
        "--csv",
        "Output all recursive fields separated by commas (e.g. for plotting). If --include-message-info is also "
        "passed, the following fields are prepended: source_timestamp, received_timestamp, "
        "publication_sequence_number, reception_sequence_number.",
    )
    parser.add_argument(
        "--field",
        help="Echo a selected field of a message. Use '.' to select sub-fields and '[i]' to select an element. "
        "For example, to echo the position field of a nav_msgs/msg/Odometry message: "
        "'ros2 topic echo /odom --field pose.pose.position'",
    )
    add_flag(
        parser,
        "--full-length -f",
        "Output all elements for arrays, bytes, and string with a length > '--truncate-length', by default they "
        "are truncated after '--truncate-length' elements with '...''",
    )
    parser.add_argument(
        "--truncate-length",
        "-l",
        type=unsigned_int,
        default=TRUNCATE_LENGTH,
        help=f"The length to truncate arrays, bytes, and string to (default: {TRUNCATE_LENGTH})",
    )
    add_flag(parser, "--no-arr", "Don't print array fields of messages")
    add_flag(parser, "--no-str", "Don't print string fields of messages")
    add_flag(parser, "--flow-style", "Print sequences in brackets (not available with csv format)")
    add_flag(parser, "--no-lost-messages", "Don't report when a message is lost")
    add_flag(parser, "--raw", "Echo the raw binary representation")
    parser.add_argument(
        "--filter",
        dest="filter_expr",
        help="Python expression to filter messages that are printed. Expression can use Python builtins as well as m "
        "(the message).",
    )
    add_flag(parser, "--once", "Print the first message received and then exit.")
    parser.add_argument(
        "--timeout", metavar="N", type=endpoints.positive_float, help="Set a timeout in seconds for waiting"
    )
    add_flag(parser, "--include-message-info -i", "Shows the associated message info.")
    add_duration_argument(parser)


def _run(args: Namespace, session: Session) -> None:
    from course_kit.ros2.topic.echo_text import expression, selector

    select = selector(args.field)
    matches = expression(args.filter_expr) if args.filter_expr else None
    topic = endpoints.full_name(args.topic_name)
    kind = _message_class(session, args, topic)
    render = _renderer(args)
    decode = (lambda data: data) if args.raw else _decoder(kind)
    with _messages(session, args, topic, kind) as arrivals:
        ends = None if args.timeout is None else time.monotonic() + args.timeout
        while ends is None or time.monotonic() < ends:
            for data, info in session.items(arrivals.queue, timeout=TICK):
                arrivals.report(session, not args.no_lost_messages)
                message = select(decode(data))
                if matches is None or matches(message):
                    session.print(render(message, info), end="")
                    if args.once:
                        return
                if ends is not None and time.monotonic() >= ends:
                    return
            arrivals.report(session, not args.no_lost_messages)


def _renderer(args: Namespace) -> Callable[[Any, dict[str, Any]], str]:
    from course_kit.ros2.messages.yaml_text import Shown
    from course_kit.ros2.topic.echo_text import message_text

    shown = Shown(None if args.full_length else args.truncate_length, args.no_arr, args.no_str)
    has_info = args.include_message_info
    return lambda message, info: message_text(message, info if has_info else None, shown, args.csv, args.flow_style)


def _decoder(kind: Any) -> Callable[[bytes], Any]:
    from rclpy.serialization import deserialize_message

    return lambda data: deserialize_message(data, kind)


# Where messages come from ----------------------------------------------------------------------------------------


def _message_class(session: Session, args: Namespace, topic: str) -> Any:
    from course_kit.ros2.messages.arguments import interface_class
    from course_kit.watching import topics

    if args.message_type is not None:
        kind = interface_class(args.message_type, "msg")
        session.graph()
        return kind
    known = dict(session.graph().get_topic_names_and_types())
    types = known.get(topic, [])
    if not types:
        session.print(f"WARNING: topic [{args.topic_name}] does not appear to be published yet")
        raise CommandError("Could not determine the type for the passed topic", did_you_mean(topic, known))
    if len(types) > 1:
        raise CommandError(
            f"Cannot echo topic '{args.topic_name}', as it contains more than one type: [{', '.join(types)}]"
        )
    try:
        return topics.message_class(types[0])
    except (ImportError, ValueError):
        raise CommandError(f"The message type '{types[0]}' is invalid") from None


@dataclass
class _Arrivals:
    """What callbacks leave for the main thread: messages, and news about the subscription."""

    queue: SimpleQueue[tuple[bytes, dict[str, Any]]] = field(default_factory=SimpleQueue)
    warnings: SimpleQueue[str] = field(default_factory=SimpleQueue)
    lost: Callable[[], int] = lambda: 0
    reported: int = 0

    def put(self, data: bytes, info: dict[str, Any]) -> None:
        if self.queue.qsize() >= WAITING:
            with suppress(Empty):
                self.queue.get_nowait()
        self.queue.put((data, info))

    def report(self, session: Session, with_lost: bool) -> None:
        while not self.warnings.empty():
            session.warn(self.warnings.get())
        total = self.lost()
        if with_lost and total > self.reported:
            from course_kit.ros2.topic.echo_text import lost_text

            session.print(lost_text(total - self.reported, total), end="")
        self.reported = total


@contextmanager
def _messages(session: Session, args: Namespace, topic: str, kind: Any) -> Iterator[_Arrivals]:
    """The messages of a topic while the block runs."""
    from course_kit.watching import instruments, topics

    arrivals = _Arrivals()
    if endpoints.is_chosen(args):
        with _as_chosen(session, args, topic, kind, arrivals):
            yield arrivals
        return
    for line in endpoints.mixed_offers(topics.publishers(session.node, topic)):
        session.print(line)
    try:
        subscription = instruments.subscribe(topic, arrivals.put, kind)
    except (TypeError, ValueError, RuntimeError) as error:
        raise CommandError(str(error)) from None
    arrivals.lost = lambda: subscription.lost
    try:
        yield arrivals
    finally:
        subscription.close(wait=False)


@contextmanager
def _as_chosen(session: Session, args: Namespace, topic: str, kind: Any, arrivals: _Arrivals) -> Iterator[None]:
    """A subscription with the QoS of the command line, exactly, that says so if it fits no publisher."""
    from course_kit.watching import instruments

    node = session.node
    qos = endpoints.chosen(args)

    def note_mismatch(policy: Any) -> None:
        arrivals.warnings.put(endpoints.incompatible(node.get_name(), topic, policy, is_publisher=False))

    try:
        subscription = instruments.subscribe_exactly(topic, arrivals.put, kind, qos, note_mismatch)
    except (TypeError, RuntimeError) as error:
        raise endpoints.refused(error, topic) from None

    arrivals.lost = lambda: subscription.lost
    try:
        yield
    finally:
        subscription.close(wait=False)


ECHO = Verb("Output messages from a topic", _run, _arguments)
