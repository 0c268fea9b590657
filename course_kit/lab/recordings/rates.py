"""Rates of any number of topics at once, from their serialised messages: no message is decoded."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from course_kit.base.arguments import COUNT, SPAN, WAIT, takes
from course_kit.base.long_tasks import long_task
from course_kit.base.polling import wait_until
from course_kit.base.text import table
from course_kit.lab.recordings import fields
from course_kit.lab.recordings.buffers import Int64s
from course_kit.lab.recordings.rate_statistics import WINDOW, ArrivalWindow, Reading, measure, spread
from course_kit.ros.subscriptions import observer_node, topics
from course_kit.ros.subscriptions.listening import Listening
from course_kit.ros.subscriptions.raw_subscriptions import Callback

UNSET = 1e7  # seconds: a message that is so old has a stamp of zero, or of a simulation's clock
DELAY = 5  # the column of it in the table


class Rates(Mapping[str, Reading]):
    """Readings by topic, shown as a table: `rates('/chatter')['/chatter'].rate` is one number."""

    def __init__(self, readings: dict[str, Reading]) -> None:
        self._readings = readings

    def __getitem__(self, topic: str) -> Reading:
        name = topics.absolute(topic)
        if name not in self._readings:
            raise KeyError(f"{name} was not measured; there are {', '.join(self._readings)}")
        return self._readings[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._readings)

    def __len__(self) -> int:
        return len(self._readings)

    def __repr__(self) -> str:
        heading = ("topic", "rate", "period min", "max", "std dev", "delay", "bandwidth", "messages", "lost", "last")
        rows = [heading, *((topic, *_cells(reading)) for topic, reading in self._readings.items())]
        if all(row[DELAY] == "-" for row in rows[1:]):  # no message with a stamp
            rows = [(*row[:DELAY], *row[DELAY + 1 :]) for row in rows]
        return table(rows, left=1)


def _cells(reading: Reading) -> tuple[str, ...]:
    last = f"{reading.age:.1f} s ago" if reading.messages else "none came"
    counts = (f"{reading.messages:,}", f"{reading.lost:,}")
    if reading.window < 2:
        return ("-", "-", "-", "-", "-", "-", *counts, last)
    period = reading.period
    times = (f"{value * 1e3:.3f} ms" for value in (period.min, period.max, period.std))
    delay = delay_text(reading.delay.mean)
    return (f"{reading.rate:,.2f} Hz", *times, delay, bandwidth_text(reading.bandwidth), *counts, last)


def delay_text(seconds: float) -> str:
    """A delay in milliseconds; a dash for messages without a stamp, or with one that was never set."""
    if not abs(seconds) < UNSET:
        return "-"
    return f"{seconds * 1e3:.3f} ms"


def bandwidth_text(bytes_per_second: float) -> str:
    """Bytes a second in the unit that fits, 1 kB = 1000 B."""
    for unit, size in (("MB/s", 1e6), ("kB/s", 1e3)):
        if bytes_per_second >= size:
            return f"{bytes_per_second / size:.2f} {unit}"
    return f"{bytes_per_second:.0f} B/s"


class RateMeter(Listening):
    """Measures topics until it is stopped; `read()` at any time. Ends too when nobody holds it any more."""

    def __init__(self, wanted: dict[str, Any], window: int) -> None:
        super().__init__()
        self._windows: dict[str, ArrivalWindow] = {}
        self._delays: dict[str, ArrivalWindow] = {}  # of topics with a stamp; nanoseconds in place of the sizes
        self._size = window
        self._add_all(wanted)

    def _callback(self, topic: str, message_type: Any) -> Callback:
        self._windows[topic] = ArrivalWindow(self._size)
        append = self._windows[topic].appender()

        def receive(message: bytes, info: dict[str, Any]) -> None:
            append(info["received_timestamp"], len(message))

        if not fields.is_stamped(message_type):
            return receive
        self._delays[topic] = ArrivalWindow(self._size)
        append_delay = self._delays[topic].appender()

        def receive_stamped(message: bytes, info: dict[str, Any]) -> None:
            received = info["received_timestamp"]
            append(received, len(message))
            append_delay(received, received - fields.stamp_ns(message))

        return receive_stamped

    def arrivals(self, topic: str) -> tuple[Int64s, Int64s, int]:
        """Receive times (nanoseconds since the epoch) and sizes (bytes) in the window, and how many came in all."""
        name = topics.absolute(topic)
        if name not in self._windows:
            raise KeyError(f"{name} was not measured; there are {', '.join(self.topics)}")
        return self._windows[name].arrivals()

    @takes(last=SPAN | None)
    def read(self, last: float | None = None) -> Rates:
        """What was measured up to now: over the last messages of each topic (the window), or the `last` seconds."""
        return Rates({topic: self._read_one(topic, last) for topic in self.topics})

    def _read_one(self, topic: str, last: float | None) -> Reading:
        now_ns = self._now()
        since = 0 if last is None else now_ns - int(last * 1e9)
        receive_ns, sizes, total = _in_order(self._windows[topic])
        first = int(np.searchsorted(receive_ns, since))
        reading = measure(receive_ns[first:], sizes[first:], total, now_ns)
        if first and first == len(receive_ns):  # nothing came lately, but the last message has its age
            reading = replace(reading, age=(now_ns - int(receive_ns[-1])) * 1e-9)
        if topic in self._delays:
            came_ns, delays, _ = _in_order(self._delays[topic])
            reading = replace(reading, delay=spread(delays[np.searchsorted(came_ns, since) :] * 1e-9))
        return replace(reading, lost=self._subscriptions[topic].lost)

    def stop(self) -> Rates:
        """End measuring and return the last reading; safe to call twice."""
        self._end()
        return self.read()

    def __repr__(self) -> str:
        return f"Rate meter, {'running' if self.is_running else 'stopped'}\n{self.read()}"


def _in_order(window: ArrivalWindow) -> tuple[Int64s, Int64s, int]:
    """What a window has, by the time of receipt: messages of two publishers may be taken a little out of order."""
    receive_ns, others, total = window.arrivals()
    order = np.argsort(receive_ns, kind="stable")
    return receive_ns[order], others[order], total


@takes(window=COUNT, timeout=WAIT)
def measure_rates(*wanted: Any, window: int = WINDOW, timeout: float = 10.0) -> RateMeter:
    """Measure topics in the background until .stop(): rate, periods, bandwidth. `.read()` gives the table so far.

    The numbers are about the last `window` messages of each topic. A type after a topic, as in
    measure_rates('/x', String), makes it ready before anybody publishes; else the publisher is waited for, up to
    `timeout` seconds, and a TimeoutError raised if none comes. Without topics: all that are published now.
    """
    pairs = topics.with_types(wanted or _published(timeout))
    return RateMeter(topics.look_up(observer_node.node(), pairs, timeout), window)


@takes(seconds=SPAN, window=COUNT, timeout=WAIT)
def rates(*wanted: Any, seconds: float = 2.0, window: int = WINDOW, timeout: float = 10.0) -> Rates:
    """Measure topics for some `seconds` and return their rates, periods and bandwidths as a table.

    Takes topics, types, `window` and `timeout` as measure_rates() does.
    """
    meter = measure_rates(*wanted, window=window, timeout=timeout)
    with meter, long_task(f"measuring {', '.join(meter.topics)}", seconds):
        time.sleep(seconds)
    return meter.read()


def _published(timeout: float) -> list[str]:
    """The topics that nodes publish, without those every node has."""
    if there := wait_until(lambda: topics.published(observer_node.node()), timeout):
        return sorted(there)
    raise TimeoutError(f"no node publishes anything (waited {timeout:g} s): is one running, in this ROS_DOMAIN_ID?")
