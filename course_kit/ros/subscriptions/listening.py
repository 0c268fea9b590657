"""Subscriptions that begin and end together."""

from __future__ import annotations

import time
import weakref
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from course_kit.ros.subscriptions import observer_node
from course_kit.ros.subscriptions.raw_subscriptions import Callback, RawSubscription

if TYPE_CHECKING:
    from typing_extensions import Self


def close_all(subscriptions: Mapping[str, RawSubscription], wait: bool = True) -> None:
    """End subscriptions by topic at once; with `wait` return when what has arrived by now is delivered."""
    for subscription in list(subscriptions.values()):
        subscription.close(wait=False)
    for subscription in list(subscriptions.values()) if wait else ():
        subscription.close()


class Listening:
    """What listens to topics until stop(), until nobody holds it any more, or until ROS is shut down."""

    def __init__(self) -> None:
        self._subscriptions: dict[str, RawSubscription] = {}
        # Nothing that the subscriptions call may refer to self: else somebody would always hold it.
        self._finalizer = weakref.finalize(self, close_all, self._subscriptions, wait=False)
        self._finalizer.atexit = False
        self._stop_ns: int | None = None

    def _callback(self, topic: str, message_type: Any) -> Callback:
        """What to call with each message of a topic."""
        raise NotImplementedError

    def add(self, topic: str, message_type: Any) -> None:
        """Listen to one topic more from now on."""
        callback = self._callback(topic, message_type)
        self._subscriptions[topic] = observer_node.subscribe(topic, callback, message_type)

    def _add_all(self, wanted: Mapping[str, Any]) -> None:
        """Listen to topics with these types; if one cannot be, to none."""
        try:
            for topic, message_type in wanted.items():
                self.add(topic, message_type)
        except BaseException:
            self._end()
            raise

    @property
    def topics(self) -> list[str]:
        """The topics, in the order in which they were named."""
        return list(self._subscriptions)

    @property
    def is_running(self) -> bool:
        """True if messages still come in: until stop(), or until ROS is shut down."""
        return any(subscription.is_open for subscription in self._subscriptions.values())

    def _now(self) -> int:
        """Nanoseconds since the epoch; once it has ended, those of the end."""
        return self._stop_ns or time.time_ns()

    def _end(self) -> None:
        """End it; what has come stays. Safe to call twice."""
        self._stop_ns = self._now()
        close_all(self._subscriptions)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._end()
