"""Service calls as data, put together from the events that clients and servers publish about them.

A client or server with `configure_introspection(...)` publishes on `<service>/_service_event` when a request or a
response is sent or received. What belongs to one call has the same sequence number and the same client.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from course_kit.base.arguments import shown

NAMES = ("request_sent", "request_received", "response_sent", "response_received")  # by service_msgs' event_type
PROCESS = 12  # bytes at the start of a gid that are the same for everything of one process


@dataclass(frozen=True)
class Call:
    """When the four events of one call happened, in seconds of the nodes' clocks; nan for one that was not reported."""

    number: int  # of the client's requests, from 1
    request_sent: float = math.nan
    request_received: float = math.nan
    response_sent: float = math.nan
    response_received: float = math.nan

    @property
    def began(self) -> float:
        """The first that is known of it."""
        return min(time for time in (getattr(self, name) for name in NAMES) if not math.isnan(time))

    @property
    def waiting(self) -> float:
        """Seconds until the executor of the server took the request: the way, and the queue."""
        return self.request_received - self.request_sent

    @property
    def working(self) -> float:
        """Seconds that the server took."""
        return self.response_sent - self.request_received

    @property
    def duration(self) -> float:
        """Seconds from the request to the response, as the client sees it."""
        return self.response_received - self.request_sent

    def queued_among(self, calls: Iterable[Call]) -> bool:
        """Return True if this one's request waited until the server had answered another of the calls."""
        return any(
            other is not self and self.request_sent < other.response_sent <= self.request_received for other in calls
        )


def calls_of(events: Iterable[Any]) -> list[Call]:
    """The calls in messages of a service's event type, in the order of their requests.

    A call of which only the server or only the client reports has the events that were reported. Two clients of one
    process on one service cannot be told apart: ValueError.
    """
    found: dict[tuple[bytes, int], dict[str, float]] = {}
    for event in events if isinstance(events, Iterable) else [events]:
        if not hasattr(event, "info"):
            raise TypeError(f"calls_of() takes messages of a topic …/_service_event, not {shown(event)}")
        info = event.info
        key = (bytes(bytearray(info.client_gid))[:PROCESS], info.sequence_number)
        times, name = found.setdefault(key, {}), NAMES[info.event_type]
        if name in times:
            raise ValueError(f"two clients of one process made a request {info.sequence_number} of this service")
        times[name] = info.stamp.sec + info.stamp.nanosec * 1e-9
    calls = [Call(number, **times) for (_, number), times in found.items()]
    return sorted(calls, key=lambda call: call.began)
