"""`ros2 topic hz`, `bw` and `delay`: how often, how much, how late.

hz and bw count serialised messages as they arrive, without decoding them, so they stay true at rates that a Python
callback for each message could not follow. Only hz with --filter, and delay, which needs the header, decode.
"""

from __future__ import annotations

import time
from argparse import Namespace
from collections import deque
from collections.abc import Callable
from contextlib import closing
from typing import TYPE_CHECKING, Any

from course_kit.ros2.completion import names_of
from course_kit.ros2.session import Session
from course_kit.ros2.topic import endpoints
from course_kit.ros2.verbs import NODE, Arguments, CommandError, Verb, all_of, argument, duration, failing, flag, number

if TYPE_CHECKING:
    from course_kit.recordings.measure import Spread
    from course_kit.watching.raw_subscriptions import RawSubscription

PERIOD = 1.0  # seconds between two lines

LARGEST_WINDOW = 10_000_000  # messages; their times and sizes take 160 MB

_count = number(int, lambda value: value > 0, "value must be a positive integer", LARGEST_WINDOW)


def bw_text(bytes_per_second: float, size: Spread, window: int) -> str:
    """What bw prints: bytes a second and the spread of the sizes, all in the unit that fits the first."""
    shown, divisor = "{:.2f} MB", 1_000_000
    if bytes_per_second < 1000:
        shown, divisor = "{:.0f} B", 1
    elif bytes_per_second < 1_000_000:
        shown, divisor = "{:.2f} KB", 1000
    total, mean, smallest, largest = (
        shown.format(value / divisor) for value in (bytes_per_second, size.mean, size.min, size.max)
    )
    return f"{total}/s from {window} messages\n\tMessage size mean: {mean} min: {smallest} max: {largest}"


def seconds_text(average: str, spread: Spread, window: int) -> str:
    """What hz and delay print: an average, the spread of times in seconds, how many these are."""
    return (
        f"average {average}\n"
        f"\tmin: {spread.min:.3f}s max: {spread.max:.3f}s std dev: {spread.std:.5f}s window: {window}"
    )


def _subscribe(session: Session, topic: str, callback: Callable[[bytes, dict[str, Any]], None]) -> RawSubscription:
    """Have the callback called, in the watching thread, with each serialised message of a topic."""
    from course_kit.watching import instruments

    kind = endpoints.type_of(session, topic, waits=True)
    with failing(ImportError, TypeError, ValueError):
        return instruments.subscribe(endpoints.full_name(topic), callback, kind)


def _hz(args: Namespace, session: Session) -> None:
    from rclpy.serialization import deserialize_message

    from course_kit.recordings.measure import ArrivalWindow, measure
    from course_kit.ros2.topic.echo_text import expression

    window = ArrivalWindow(args.window + 1)  # so many periods
    append = window.appender()
    matches = expression(args.filter) if args.filter else None
    failures: deque[CommandError] = deque(maxlen=1)

    def receive(data: bytes, info: dict[str, Any]) -> None:
        try:
            if matches is None or matches(deserialize_message(data, subscription.message_type)):
                append(info["received_timestamp"], len(data))
        except CommandError as error:  # it belongs to the main thread
            failures.append(error)

    last = 0
    with closing(_subscribe(session, args.topic_name, receive)) as subscription:
        while True:
            session.sleep(PERIOD)
            if failures:
                raise failures[0]
            receive_ns, sizes, count = window.arrivals()
            if count > max(last, 1):
                reading = measure(receive_ns, sizes, count)
                session.print(seconds_text(f"rate: {reading.rate:.3f}", reading.period, reading.window - 1))
                last = count


def _bw(args: Namespace, session: Session) -> None:
    from course_kit.recordings.measure import ArrivalWindow, spread

    window = ArrivalWindow(max(args.window, 2))
    append = window.appender()
    with closing(_subscribe(session, args.topic, lambda data, info: append(info["received_timestamp"], len(data)))):
        session.print(f"Subscribed to [{args.topic}]")
        while True:
            session.sleep(PERIOD)
            receive_ns, sizes, _ = window.arrivals()
            if len(sizes) < 2:
                continue
            # As the real command: up to now, so that a topic that falls silent fades.
            seconds = (time.time_ns() - int(receive_ns[0])) * 1e-9
            if seconds > 0:
                session.print(bw_text(float(sizes.sum()) / seconds, spread(sizes), len(sizes)))


def _delay(args: Namespace, session: Session) -> None:
    from rclpy.serialization import deserialize_message

    from course_kit.recordings.measure import spread
    from course_kit.watching import topics

    kind = topics.message_class(endpoints.type_of(session, args.topic, waits=True))
    if "header" not in kind.get_fields_and_field_types():
        raise CommandError("msg does not have header")
    delays: deque[float] = deque(maxlen=args.window)
    count = last = 0

    def receive(data: bytes, info: dict[str, Any]) -> None:
        nonlocal count
        stamp = deserialize_message(data, kind).header.stamp
        delays.append((info["received_timestamp"] - (stamp.sec * 10**9 + stamp.nanosec)) * 1e-9)
        count += 1

    with closing(_subscribe(session, args.topic, receive)):
        while True:
            session.sleep(PERIOD)
            if count > last:
                last, values = count, list(delays)
                delay = spread(values)
                session.print(seconds_text(f"delay: {delay.mean:.3f}", delay, len(values)))
            elif last:
                session.print("no new messages")


def _measured(topic: str, window: int, *more: Arguments) -> Arguments:
    """The arguments of all three; `topic` is what the usage calls it."""
    return all_of(
        argument(topic, "the topic, such as /scan", names_of("topic")),
        argument("--window -w", f"over the last so many messages (default: {window})", type=_count, default=window),
        *more,
        NODE,
        duration,
    )


HZ = Verb(
    "measure how many messages of a topic arrive a second",
    _hz,
    _measured(
        "topic_name",
        10_000,
        argument("--filter", "only messages m for which this Python expression is true", metavar="EXPR"),
        flag("--wall-time", "accepted: it is always the wall clock that counts"),
    ),
)
BW = Verb("measure how many bytes of a topic arrive a second", _bw, _measured("topic", 100))
DELAY = Verb("measure how long after its stamp each message arrives", _delay, _measured("topic", 10_000))
