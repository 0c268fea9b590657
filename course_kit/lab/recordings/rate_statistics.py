"""Rate, periods, sizes and bandwidth of messages, from when they came and how big they were. Pure: no ROS."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from course_kit.lab.recordings.buffers import Int64s

Float64s = npt.NDArray[np.float64]
BINS = 100  # spans of time in which a rate over time is told
WINDOW = 10_000  # messages; that of `ros2 topic hz`


@dataclass(frozen=True)
class Spread:
    """Mean, smallest, largest and population standard deviation; nan without values."""

    mean: float
    min: float
    max: float
    std: float


NO_SPREAD = Spread(math.nan, math.nan, math.nan, math.nan)


def spread(values: npt.ArrayLike) -> Spread:
    """The spread of some numbers, in their unit."""
    array = np.asarray(values, np.float64)
    if not array.size:
        return NO_SPREAD
    return Spread(float(array.mean()), float(array.min()), float(array.max()), float(array.std()))


@dataclass(frozen=True)
class Reading:
    """What was measured on one topic. Without two messages rate, period and bandwidth are nan."""

    messages: int  # that came in all
    window: int  # the last of them, which the numbers below are about
    rate: float  # Hz
    period: Spread  # seconds between messages
    size: Spread  # bytes, serialised
    bandwidth: float  # bytes a second
    age: float  # seconds since the last message
    lost: int = 0  # messages that the middleware noticed missing
    delay: Spread = NO_SPREAD  # seconds from the stamp to the receipt, of messages that have a stamp


def measure(receive_ns: Int64s, sizes: Int64s, total: int | None = None, now_ns: int | None = None) -> Reading:
    """Measure messages from their receive times (nanoseconds, in order of arrival) and sizes (bytes).

    The rate is (n - 1) / (last - first), as `ros2 topic hz` computes it. `total` is how many came in all, if these
    are only the last; `now_ns` is what the age is measured from, else the last message.
    """
    if len(receive_ns) != len(sizes):
        raise ValueError(f"{len(receive_ns)} receive times for {len(sizes)} sizes: each message has one of both")
    count = len(receive_ns)
    # Differences of integers first: float64 cannot hold nanoseconds since the epoch.
    seconds = int(receive_ns[-1] - receive_ns[0]) * 1e-9 if count > 1 else 0.0
    rate = (count - 1) / seconds if seconds > 0 else math.nan
    size = spread(sizes)
    age = (now_ns - int(receive_ns[-1])) * 1e-9 if now_ns is not None and count else 0.0 if count else math.nan
    return Reading(
        messages=count if total is None else total,
        window=count,
        rate=rate,
        period=spread(np.diff(receive_ns) * 1e-9),
        size=size,
        bandwidth=rate * size.mean,
        age=age,
    )


def rate_over_time(receive_ns: Int64s) -> tuple[Float64s, Float64s]:
    """The rate in equal spans of time: edges in seconds since the first message, (spans + 1,), and Hz, (spans,).

    A message counts for the span before it in proportion, so a steady topic gives a level line and not a comb.
    There are fewer spans if there are fewer than 10 messages for each. Raises ValueError below two messages.
    """
    if len(receive_ns) < 2 or receive_ns[-1] == receive_ns[0]:
        raise ValueError(f"a rate needs two messages, and there are {len(receive_ns)}")
    seconds = np.asarray((receive_ns - receive_ns[0]) * 1e-9, np.float64)
    count = max(1, min(BINS, (len(seconds) - 1) // 10))
    edges = np.linspace(0.0, seconds[-1], count + 1)
    arrived = np.interp(edges, seconds, np.arange(len(seconds)))
    return edges, np.diff(arrived) / np.diff(edges)


class ArrivalWindow:
    """When the last messages of a topic came and how big they were. One thread adds, any thread reads."""

    def __init__(self, window: int = WINDOW) -> None:
        if window < 2:
            raise ValueError(f"window={window} is too little: a rate needs two messages")
        self._size = window
        self._receive_ns: Int64s = np.empty(window, np.int64)
        self._sizes: Int64s = np.empty(window, np.int64)
        self._lock = threading.Lock()
        self._count = 0

    def appender(self) -> Callable[[int, int], None]:
        """A function (receive_ns, size) for the callback of a subscription: under a microsecond a message."""
        receive, sizes, lock, size = self._receive_ns.data, self._sizes.data, self._lock, self._size

        def append(receive_ns: int, message_size: int) -> None:
            with lock:
                place = self._count % size
                receive[place] = receive_ns
                sizes[place] = message_size
                self._count += 1

        return append

    @property
    def count(self) -> int:
        """How many messages came in all."""
        return self._count

    def clear(self) -> None:
        """Forget all that came."""
        with self._lock:
            self._count = 0

    def arrivals(self) -> tuple[Int64s, Int64s, int]:
        """Receive times and sizes of the last messages, oldest first, and how many came in all."""
        with self._lock:
            count, receive_ns, sizes = self._count, self._receive_ns.copy(), self._sizes.copy()
        if count <= self._size:
            return receive_ns[:count], sizes[:count], count
        first = -(count % self._size)
        return np.roll(receive_ns, first), np.roll(sizes, first), count
