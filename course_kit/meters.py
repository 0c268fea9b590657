"""Rates of any number of topics at once, from their serialised messages: no message is decoded."""

from __future__ import annotations

import time
import weakref
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from course_kit import instruments, topics
from course_kit.buffers import Int64s
from course_kit.measure import WINDOW, ArrivalWindow, Reading, measure
from course_kit.raw_subscriptions import RawSubscription
from course_kit.text import table


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
        rows: list[tuple[str, ...]] = [
            ("topic", "rate", "period min", "max", "std dev", "bandwidth", "messages", "lost", "last")
        ]
        for topic, reading in self._readings.items():
            rows.append((topic, *_cells(reading)))
        return table(rows, left=1)


def _cells(reading: Reading) -> tuple[str, ...]:
    last = f"{reading.age:.1f} s ago" if reading.messages else "none came"
    counts = (f"{reading.messages:,}", f"{reading.lost:,}")
    if reading.window < 2:
        return ("-", "-", "-", "-", "-", *counts, last)
    period = reading.period
    times = (f"{value * 1e3:.3f} ms" for value in (period.min, period.max, period.std))
    return (f"{reading.rate:,.2f} Hz", *times, bandwidth_text(reading.bandwidth), *counts, last)


def bandwidth_text(bytes_per_second: float) -> str:
    """Bytes a second in the unit that fits, 1 kB = 1000 B."""
    for unit, size in (("MB/s", 1e6), ("kB/s", 1e3)):
        if bytes_per_second >= size:
            return f"{bytes_per_second / size:.2f} {unit}"
    return f"{bytes_per_second:.0f} B/s"


class RateMeter:
    """Measures topics until it is stopped; `read()` at any time. Ends too when nobody holds it any more."""

    def __init__(self, wanted: dict[str, Any], window: int) -> None:
        self._windows = {topic: ArrivalWindow(window) for topic in wanted}
        self._subscriptions: dict[str, RawSubscription] = {}
        self._finalizer = weakref.finalize(self, _close, self._subscriptions)
        self._finalizer.atexit = False
        self._stop_ns: int | None = None
        try:
            for topic, message_type in wanted.items():
                receive = _receiver(self._windows[topic])
                self._subscriptions[topic] = instruments.subscribe(topic, receive, message_type)
        except BaseException:
            self.stop()
            raise

    @property
    def topics(self) -> list[str]:
        return list(self._windows)

    @property
    def is_running(self) -> bool:
        """Whether it still measures: until stop(), or until ROS is shut down."""
        return any(s.is_open for s in self._subscriptions.values())

    def arrivals(self, topic: str) -> tuple[Int64s, Int64s, int]:
        """Receive times (nanoseconds since the epoch) and sizes (bytes) in the window, and how many came in all."""
        return self._windows[topics.absolute(topic)].arrivals()

    def read(self) -> Rates:
        """What was measured up to now, over the last messages of each topic (the window)."""
        arrivals = {topic: window.arrivals() for topic, window in self._windows.items()}
        now_ns = self._stop_ns or time.time_ns()
        readings = {topic: measure(*of_topic, now_ns) for topic, of_topic in arrivals.items()}
        lost = {topic: subscription.lost for topic, subscription in self._subscriptions.items()}
        return Rates({topic: replace(one, lost=lost.get(topic, 0)) for topic, one in readings.items()})

    def stop(self) -> Rates:
        """End measuring and return the last reading; safe to call twice."""
        self._stop_ns = self._stop_ns or time.time_ns()
        _close(self._subscriptions, wait=True)
        return self.read()

    def __enter__(self) -> RateMeter:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def __repr__(self) -> str:
        return f"Rate meter, {'running' if self.is_running else 'stopped'}\n{self.read()}"


def _close(subscriptions: dict[str, RawSubscription], wait: bool = False) -> None:
    for subscription in list(subscriptions.values()):
        subscription.close(wait=wait)


def _receiver(window: ArrivalWindow) -> Callable[[bytes, dict[str, Any]], None]:
    append = window.appender()

    def receive(message: bytes, info: dict[str, Any]) -> None:
        append(info["received_timestamp"], len(message))

    return receive


def measure_rates(*wanted: Any, window: int = WINDOW, timeout: float = 10.0) -> RateMeter:
    """Measure topics in the background until .stop(): rate, periods, bandwidth. `.read()` gives the table so far.

    The numbers are about the last `window` messages of each topic. A type after a topic, as in
    measure_rates('/x', String), makes it ready before anybody publishes; else the publisher is waited for, up to
    `timeout` seconds, and a TimeoutError raised if none comes. Without topics: all that are published now.
    """
    pairs = topics.with_types(wanted or _published(timeout))
    return RateMeter(topics.look_up(instruments.node(), pairs, timeout), window)


def rates(*wanted: Any, seconds: float = 2.0, window: int = WINDOW, timeout: float = 10.0) -> Rates:
    """Measure topics for some `seconds` and return their rates, periods and bandwidths as a table.

    Takes topics, types, `window` and `timeout` as measure_rates() does.
    """
    with measure_rates(*wanted, window=window, timeout=timeout) as meter:
        time.sleep(seconds)
    return meter.read()


def _published(timeout: float) -> list[str]:
    """The topics that nodes publish, without those every node has."""
    node = instruments.node()

    def names() -> list[str]:
        there = [name for name, _ in node.get_topic_names_and_types()]
        return [n for n in there if n not in ("/rosout", "/parameter_events") and node.count_publishers(n)]

    if not topics.wait_until(names, timeout):
        raise TimeoutError(f"no node publishes anything (waited {timeout:g} s): is one running, in this ROS_DOMAIN_ID?")
    return sorted(names())
