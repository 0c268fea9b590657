"""The one wait for a condition, with a time-out."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import TypeVar

Value = TypeVar("Value")
POLL = 0.02  # seconds between two looks


def wait_until(
    condition: Callable[[], Value],
    timeout: float | None,
    poll: float = POLL,
    pause: Callable[[float], object] = time.sleep,
) -> Value:
    """Look at a condition until it is true or `timeout` seconds are over; return its last value.

    Without a timeout it waits on. `pause(seconds)` lets others go on for at most `poll` seconds between two looks.
    """
    deadline = math.inf if timeout is None else time.monotonic() + timeout
    while not (value := condition()) and (left := deadline - time.monotonic()) > 0:
        pause(min(poll, left))
    return value
