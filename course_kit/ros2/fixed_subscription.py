"""A subscription that keeps the QoS it was given, whatever publishers offer, taken from by the thread that reads it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from rclpy.node import Node
from rclpy.qos import QoSProfile

from course_kit.raw_subscriptions import Callback, RawSubscription


class FixedSubscription(RawSubscription):
    """Unlike those of the instruments it does not ask for less when a publisher offers less.

    take() calls `callback(serialised message, message info)` for what has arrived.
    """

    def __init__(self, node: Node, topic: str, message_type: Any, qos: QoSProfile, callback: Callback) -> None:
        unwatched: Any = SimpleNamespace(node=node, wake=lambda: None, is_current_thread=lambda: True)
        super().__init__(unwatched, topic, message_type, qos, callback)

    def take(self) -> None:
        """Hand over what has arrived, and count what was lost."""
        with self.in_use():
            self.drain(_raise)
            self.count_lost()

    def refused_policy(self) -> Any:
        """The policy in which a publisher that came since the last call does not fit, or None."""
        with self.in_use():
            event = self._refused.take_event()
        return event.last_policy_kind if event.total_count_change else None


def _raise(error: Exception) -> None:
    raise error
