"""`ros2 topic hz`, `bw` and `delay`: how often, how much, how late.

hz and bw count serialised messages as they arrive, without decoding them, so they stay true at rates that a Python
callback for each message could not follow. Only hz with --filter, and delay, which needs the header, decode. What a
publisher has kept from before is not counted: it does not come at the topic's rate.
"""

from __future__ import annotations

from argparse import SUPPRESS, Namespace
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any

from course_kit.cli.ros2.completion import names_of
from course_kit.cli.ros2.session import Session
from course_kit.cli.ros2.topic import clock, endpoints
from course_kit.cli.ros2.topic.clock import Clock
from course_kit.cli.ros2.topic.hz_bw_delay_text import bw_text, hz_table, hz_text, seconds_text
from course_kit.cli.ros2.verbs import (
    NODE,
    Arguments,
    CommandError,
    Verb,
    all_of,
    argument,
    duration,
    failing,
    flag,
    number,
)

if TYPE_CHECKING:
    from course_kit.lab.recordings.rate_statistics import ArrivalWindow

PERIOD = 1.0  # seconds between two lines
LEAST = 3  # messages before hz says anything, as the real one: two periods

LARGEST_WINDOW = 10_000_000  # messages; their times and sizes take 160 MB

_count = number(int, lambda value: value > 0, "value must be a positive integer", LARGEST_WINDOW)

Measured = Callable[[bytes, int], int | None]  # what is kept of a message, given when it came; None: it is left out


class _Topic:
    """The last messages of a topic: when they came, and a number of each. Messages come in the watching thread."""

    def __init__(self, window: ArrivalWindow, clock: Clock, measured: Measured) -> None:
        self.window = window
        self._clock, self._measured = clock, measured
        self._failures: SimpleQueue[CommandError] = SimpleQueue()
        self._notes: SimpleQueue[str] = SimpleQueue()
        self._last = 0
        self._shown = 0

    def receiver(self) -> Callable[[bytes, dict[str, Any]], None]:
        """What the subscription calls: about a microsecond a message on the wall clock."""
        append, measured, received = self.window.appender(), self._measured, self._clock.received
        is_simulated = self._clock.is_simulated

        def receive(data: bytes, info: dict[str, Any]) -> None:
            time_ns = received(info)
            if is_simulated and not self._goes_on(time_ns):
                return
            try:
                kept = measured(data, time_ns)
            except CommandError as error:  # it belongs to the main thread
                self._failures.put(error)
                return
            if kept is not None:
                append(time_ns, kept)

        return receive

    def _goes_on(self, time_ns: int) -> bool:
        """Return True if the message has a time; what came before is forgotten if the simulation began anew."""
        if time_ns == 0 and self.window.count:
            self._notes.put("time has reset, resetting counters")
        if time_ns < self._last:
            self.window.clear()
            self._shown = 0
        self._last = time_ns
        return time_ns > 0

    def has_news(self, session: Session, least: int = 1) -> bool:
        """Return True if messages came since the last call, at least `least` in all. Raises what failed meanwhile."""
        while not self._notes.empty():
            session.print(self._notes.get())
        if not self._failures.empty():
            raise self._failures.get()
        count = self.window.count
        if count < least or count == self._shown:
            return False
        self._shown = count
        return True


@contextmanager
def _listening(
    session: Session, topic: str, size: int, clock: Clock, measured: Callable[[Any], Measured]
) -> Iterator[_Topic]:
    """A topic that is listened to while the block runs; `measured` gives what is kept of messages of a class."""
    from course_kit.lab.recordings.rate_statistics import ArrivalWindow
    from course_kit.ros.subscriptions import observer_node, topics

    name = endpoints.type_of(session, topic, waits=True)
    with failing(ImportError, TypeError, ValueError):
        kind = topics.message_class(name)
        heard = _Topic(ArrivalWindow(max(size, 2)), clock, measured(kind))
        subscription = observer_node.subscribe(endpoints.full_name(topic), heard.receiver(), kind, with_kept=False)
    with closing(subscription):
        yield heard


def _size(kind: Any) -> Measured:
    return lambda data, time_ns: len(data)


def _size_of_matching(text: str) -> Callable[[Any], Measured]:
    """The size of messages for which a Python expression is true."""
    from rclpy.serialization import deserialize_message

    from course_kit.cli.ros2.topic.echo_text import expression

    matches = expression(text)
    return lambda kind: lambda data, time_ns: len(data) if matches(deserialize_message(data, kind)) else None


def _delay_of(kind: Any) -> Measured:
    """How long after its stamp a message came, in nanoseconds."""
    from rclpy.serialization import deserialize_message

    if "header" not in kind.get_fields_and_field_types():
        raise CommandError("msg does not have header")

    def delay(data: bytes, time_ns: int) -> int:
        stamp = deserialize_message(data, kind).header.stamp
        return time_ns - (int(stamp.sec) * 10**9 + int(stamp.nanosec))

    return delay


def _hz(args: Namespace, session: Session) -> None:
    import numpy as np

    from course_kit.lab.recordings.rate_statistics import Reading, measure

    measured = _size_of_matching(args.filter) if args.filter else _size
    names = list(dict.fromkeys([args.topic_name, *args.more_topics]))

    def read(heard: _Topic) -> Reading:
        receive_ns, sizes, count = heard.window.arrivals()
        # Those of two publishers may be taken a little out of order.
        return measure(np.sort(receive_ns), sizes, count)

    with ExitStack() as stack:
        time = stack.enter_context(clock.chosen(session, args))
        heard = {}
        for name in names:
            heard[name] = stack.enter_context(_listening(session, name, args.window + 1, time, measured))
            if len(names) > 1:
                session.print(f"Subscribed to [{name}]")
        for _ in time.passes(session, PERIOD):
            readings = {name: read(one) for name, one in heard.items() if one.has_news(session, LEAST)}
            if readings:
                session.print(hz_text(readings[names[0]]) if len(names) == 1 else hz_table(readings))


def _bw(args: Namespace, session: Session) -> None:
    from course_kit.lab.recordings.rate_statistics import spread

    with clock.chosen(session, args) as time, _listening(session, args.topic, args.window, time, _size) as heard:
        session.print(f"Subscribed to [{args.topic}]")
        for _ in time.passes(session, PERIOD):
            heard.has_news(session)
            receive_ns, sizes, _ = heard.window.arrivals()
            if len(sizes) < 2:
                continue
            # As the real command: up to now, so that a topic that falls silent fades.
            seconds = (time.now() - int(receive_ns[0])) * 1e-9
            if seconds > 0:
                session.print(bw_text(float(sizes.sum()) / seconds, spread(sizes), len(sizes)))


def _delay(args: Namespace, session: Session) -> None:
    from course_kit.lab.recordings.rate_statistics import spread

    with clock.chosen(session, args) as time, _listening(session, args.topic, args.window, time, _delay_of) as heard:
        for _ in time.passes(session, PERIOD):
            if heard.has_news(session):
                delays = heard.window.arrivals()[1][-args.window :]
                delay = spread(delays * 1e-9)
                session.print(seconds_text(f"delay: {delay.mean:.3f}", delay, len(delays)))
            elif heard.window.count:
                session.print("no new messages")


def _arguments(topic: str, window: int, *more: Arguments) -> Arguments:
    """The arguments of all three; `topic` is what the usage calls it."""
    return all_of(
        argument(topic, "the topic, such as /scan", names_of("topic")),
        argument("--window -w", f"measure the last N messages (default: {window})", type=_count, default=window),
        *more,
        NODE,
        duration,
    )


HZ = Verb(
    "measure the rate of a topic, or of several, in Hz",
    _hz,
    _arguments(
        "topic_name",
        10_000,
        argument("--filter", "count only messages m for which this Python expression is true", metavar="EXPR"),
        flag("--wall-time", "use the wall clock, also with -s"),
        # As in the successors of Jazzy; the usage is Jazzy's.
        argument("more_topics", SUPPRESS, names_of("topic"), nargs="*", default=[]),
    ),
)
BW = Verb("measure the bandwidth of a topic", _bw, _arguments("topic", 100))
DELAY = Verb("measure the delay between the stamp of a message and its arrival", _delay, _arguments("topic", 10_000))
