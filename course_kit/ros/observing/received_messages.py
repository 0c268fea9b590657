"""The messages that a subscription of an observer has received: with the time and the publisher of each."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Collection
from dataclasses import dataclass
from typing import Any

from rclpy.serialization import deserialize_message

from course_kit.ros.subscriptions.raw_subscriptions import RawSubscription

KEPT = 20_000  # messages of one subscription
KEPT_CHANGES = 50_000  # of one that is listened to for hours: a turtle moves for 13 minutes in as many poses


@dataclass(slots=True)
class Arrival:
    """One message: when the middleware received it (nanoseconds since the epoch), its publisher's id, itself."""

    received: int
    publisher: bytes  # b"" where the middleware does not tell
    serialised: bytes
    message: Any = None  # once it was asked for: checks look again and again, beside a simulator that must not wait

    def repeats(self, other: Arrival) -> bool:
        """Return True if the same publisher says the same again."""
        return (self.publisher, self.serialised) == (other.publisher, other.serialised)


class ReceivedMessages:
    """The messages of one topic that count, in order.

    `counts` says of a publisher's id whether its messages count: those of other nodes may come at any time.
    """

    def __init__(
        self, message_type: Any, topic: str = "", counts: Callable[[bytes], bool] | None = None, changes: bool = False
    ) -> None:
        """`changes`: of messages that say the same only the first and the last is kept: for a topic heard for hours."""
        self.topic = topic
        self.type = message_type
        self._counts = counts or (lambda publisher: True)
        self._changes = changes
        self._kept: deque[Arrival] = deque(maxlen=KEPT_CHANGES if changes else KEPT)
        self._lock = threading.Lock()
        self.received = 0  # messages in all, whoever sent them, also those that are not kept
        self.subscription: RawSubscription  # once it is listened to

    def receive(self, serialised: bytes, info: dict[str, Any]) -> None:
        """Keep a message; called in the watching thread."""
        arrival = Arrival(info["received_timestamp"], info.get("publisher", b""), serialised)
        with self._lock:
            self.received += 1
            kept = self._kept
            if self._changes and len(kept) > 1 and arrival.repeats(kept[-1]) and arrival.repeats(kept[-2]):
                kept.pop()
            kept.append(arrival)

    def __len__(self) -> int:
        return len(self._all())

    def _all(self) -> list[Arrival]:
        with self._lock:
            kept = list(self._kept)
        counts = {publisher: self._counts(publisher) for publisher in {one.publisher for one in kept}}
        return [one for one in kept if counts[one.publisher]]

    def _read(self, arrival: Arrival) -> Any:
        if arrival.message is None:
            arrival.message = deserialize_message(arrival.serialised, self.type)
        return arrival.message

    @property
    def times(self) -> list[int]:
        """When each message came, in nanoseconds since the epoch, oldest first."""
        return [one.received for one in self._all()]

    @property
    def arrivals(self) -> list[tuple[int, Any]]:
        """When each message came, and the message, oldest first."""
        return [(one.received, self._read(one)) for one in self._all()]

    @property
    def messages(self) -> list[Any]:
        """The messages, oldest first."""
        return [message for _, message in self.arrivals]

    @property
    def publisher_count(self) -> int:
        """How many publishers are matched."""
        return self.subscription.publisher_count

    def of(self, publishers: Collection[bytes]) -> list[tuple[int, Any]]:
        """The arrivals that came from these publishers; all where the middleware does not tell who sent them."""
        return [
            (one.received, self._read(one)) for one in self._all() if not one.publisher or one.publisher in publishers
        ]

    @property
    def last(self) -> Any:
        """The newest message. IndexError if none has come."""
        return self._read(self._all()[-1])
