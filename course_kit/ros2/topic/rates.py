"""`ros2 topic hz`, `bw` and `delay`: how often, how much, how late.

hz and bw count serialised messages as they arrive, without decoding them, so they stay true at rates that a Python
callback for each message could not follow. Only hz with --filter, and delay, which needs the header, decode.
"""

from __future__ import annotations

import time
from argparse import ArgumentParser, ArgumentTypeError, Namespace
from collections import deque
from collections.abc import Callable
from contextlib import closing
from typing import TYPE_CHECKING, Any

from course_kit.ros2.completion import names_of
from course_kit.ros2.session import Session
from course_kit.ros2.topic import endpoints
from course_kit.ros2.verbs import CommandError, Verb, add_duration_argument, add_node_arguments, add_offered

if TYPE_CHECKING:
    from course_kit.recordings.measure import Spread
    from course_kit.watching.raw_subscriptions import RawSubscription

PERIOD = 1.0  # seconds between two lines
HZ_WINDOW, BW_WINDOW, DELAY_WINDOW = 10_000, 100, 10_000


def _positive_int(text: str) -> int:
    if not text.isdigit() or int(text) == 0:
        raise ArgumentTypeError("value must be a positive integer")
    return int(text)


def hz_text(rate: float, period: Spread, window: int) -> str:
    """What hz prints: the rate in Hz, the spread of the periods in seconds, how many periods these are."""
    return (
        f"average rate: {rate:.3f}\n"
        f"\tmin: {period.min:.3f}s max: {period.max:.3f}s std dev: {period.std:.5f}s window: {window}"
    )


def bw_text(bytes_per_second: float, size: Spread, window: int) -> str:
    """What bw prints: bytes a second and the spread of the sizes, all in the unit that fits the first."""
    if bytes_per_second < 1000:
        shown = "{:.0f} B"
        divisor = 1
    elif bytes_per_second < 1_000_000:
        shown, divisor = "{:.2f} KB", 1000
    else:
        shown, divisor = "{:.2f} MB", 1_000_000
    total, mean, smallest, largest = (
        shown.format(value / divisor) for value in (bytes_per_second, size.mean, size.min, size.max)
    )
    return f"{total}/s from {window} messages\n\tMessage size mean: {mean} min: {smallest} max: {largest}"


def delay_text(delay: Spread, window: int) -> str:
    """What delay prints: the spread of the delays in seconds."""
    return (
        f"average delay: {delay.mean:.3f}\n"
        f"\tmin: {delay.min:.3f}s max: {delay.max:.3f}s std dev: {delay.std:.5f}s window: {window}"
    )


def _wait_for_type(session: Session, topic: str) -> str:
    """The type of a topic; waits for one to appear, with the real command's warning."""
    from course_kit.watching import topics

    name = endpoints.full_name(topic)
    found = dict(session.graph().get_topic_names_and_types()).get(name, [])
    if not found:
        session.print(f"WARNING: topic [{topic}] does not appear to be published yet")
        session.until(lambda: name in dict(session.node.get_topic_names_and_types()), poll=0.05)
        found = dict(session.node.get_topic_names_and_types())[name]
    types = sorted({p.topic_type for p in topics.publishers(session.node, name)}) or found
    if len(types) > 1:
        raise CommandError(f"Cannot echo topic '{topic}', as it contains more than one type: [{', '.join(types)}]")
    return types[0]


def _subscribe(session: Session, topic: str, callback: Callable[[bytes, dict[str, Any]], None]) -> RawSubscription:
    """Have the callback called, in the watching thread, with each serialised message of a topic."""
    from course_kit.watching import instruments

    kind = _wait_for_type(session, topic)
    try:
        return instruments.subscribe(endpoints.full_name(topic), callback, kind)
    except (ImportError, TypeError, ValueError) as error:
        raise CommandError(str(error)) from None


def _hz_arguments(parser: ArgumentParser) -> None:
    parser.description = (
        "Print the average receiving rate to screen.\n\nnote:\n  This rate is the one at which messages arrive here, "
        "which the machine's load and the QoS may make differ from the publisher's."
    )
    add_offered(parser, "topic_name", names_of("topic"), "Name of the ROS topic to listen to (e.g. '/chatter')")
    parser.add_argument(
        "--window",
        "-w",
        dest="window_size",
        type=_positive_int,
        default=HZ_WINDOW,
        help=f"window size, in # of messages, for calculating rate (default: {HZ_WINDOW})",
        metavar="WINDOW",
    )
    parser.add_argument(
        "--filter",
        dest="filter_expr",
        default=None,
        help="only measure messages matching the specified Python expression",
        metavar="EXPR",
    )
    parser.add_argument(
        "--wall-time",
        dest="use_wtime",
        action="store_true",
        help="calculates rate using wall time which can be helpful when clock is not published during simulation",
    )
    add_node_arguments(parser)
    add_duration_argument(parser)


def _hz(args: Namespace, session: Session) -> None:
    from rclpy.serialization import deserialize_message

    from course_kit.recordings.measure import ArrivalWindow, measure
    from course_kit.ros2.topic.echo_text import expression

    window = ArrivalWindow(args.window_size + 1)  # so many periods
    append = window.appender()
    matches = expression(args.filter_expr) if args.filter_expr else None
    failures: deque[str] = deque(maxlen=1)

    def receive(data: bytes, info: dict[str, Any]) -> None:
        if matches is not None:
            try:
                if not matches(deserialize_message(data, subscription.message_type)):
                    return
            except CommandError as error:  # it belongs to the main thread
                failures.append(str(error))
                return
        append(info["received_timestamp"], len(data))

    last = 0
    with closing(_subscribe(session, args.topic_name, receive)) as subscription:
        while True:
            session.sleep(PERIOD)
            if failures:
                raise CommandError(failures[0])
            receive_ns, sizes, count = window.arrivals()
            if count > max(last, 1):
                reading = measure(receive_ns, sizes, count)
                session.print(hz_text(reading.rate, reading.period, reading.window - 1))
                last = count


def _topic_and_window(parser: ArgumentParser, topic: str, window: str, default: int) -> None:
    """The arguments of bw and delay, with what the help says of each."""
    add_offered(parser, "topic", names_of("topic"), topic)
    parser.add_argument(
        "--window", "-w", type=_positive_int, default=default, help=f"{window} (default: {default})", metavar="WINDOW"
    )
    add_node_arguments(parser)
    add_duration_argument(parser)


def _bw_arguments(parser: ArgumentParser) -> None:
    _topic_and_window(
        parser,
        "Topic name to monitor for bandwidth utilization",
        "maximum window size, in # of messages, for calculating rate",
        BW_WINDOW,
    )


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


def _delay_arguments(parser: ArgumentParser) -> None:
    _topic_and_window(
        parser,
        "Topic name to calculate the delay for",
        "window size, in # of messages, for calculating rate, string to",
        DELAY_WINDOW,
    )


def _delay(args: Namespace, session: Session) -> None:
    from rclpy.serialization import deserialize_message

    from course_kit.recordings.measure import spread
    from course_kit.watching import topics

    kind = topics.message_class(_wait_for_type(session, args.topic))
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
            if count == last:
                if last:
                    session.print("no new messages")
                continue
            last = count
            values = list(delays)
            session.print(delay_text(spread(values), len(values)))


HZ = Verb("Print the average receiving rate to screen", _hz, _hz_arguments)
BW = Verb("Display bandwidth used by topic", _bw, _bw_arguments)
DELAY = Verb("Display delay of topic from timestamp in header", _delay, _delay_arguments)
