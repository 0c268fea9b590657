"""Sends what a form holds, in the background: a topic's message, a service's request, an action's goal."""

from __future__ import annotations

import contextlib
from dataclasses import replace
from typing import Any

from rclpy.event_handler import PublisherEventCallbacks
from rclpy.qos import qos_policy_name_from_kind

from course_kit.cli.ros2.messages.values import stamp
from course_kit.ros.subscriptions import observer_node
from course_kit.views.forms.calling import GoalSender, ServiceCaller
from course_kit.views.forms.interface import ACTION, SERVICE, Interface
from course_kit.views.forms.sender import Sender, State


def sender(interface: Interface) -> Sender:
    """What sends to a topic, a service or an action."""
    return {SERVICE: ServiceCaller, ACTION: GoalSender}.get(interface.noun, Publishing)(interface)


class Publishing(Sender):
    """Publishes messages once, or at a rate."""

    def __init__(self, interface: Interface) -> None:
        super().__init__(interface)
        self._node, self._executor = observer_node.node(), observer_node.executor()
        self._timer: Any = None
        self._rate = 0.0
        self._sent = 0
        self._refused = ""
        self._is_closed = False
        self._message, self._times = self._filled({})
        self._publisher = self._node.create_publisher(
            interface.type,
            interface.name,
            10,
            event_callbacks=PublisherEventCallbacks(incompatible_qos=self._on_incompatible),
        )

    @property
    def state(self) -> State:
        """How many were sent to how many."""
        if self._is_closed or self._state.is_problem or not (self._sent or self._timer):
            return self._state
        listening = self._publisher.get_subscription_count()
        rate = f"publishing at {self._rate:g} Hz, " if self._timer else ""
        to = f"{listening} subscription{'' if listening == 1 else 's'}"
        if not listening:
            to = f"nobody: no node subscribes to {self.interface.name}"
        return replace(
            self._state, line=f"{rate}{self._sent:,} sent, to {to}{self._refused}", is_busy=bool(self._timer)
        )

    def send(self, value: Any) -> None:
        """Publish it once."""
        self.update(value)
        self._publish()

    def start(self, value: Any, rate: float) -> None:
        """Publish it so many times a second, until stop()."""
        self.stop()
        self.update(value)
        self._rate = rate
        self._publish()
        self._timer = self._node.create_timer(1 / rate, self._publish)

    def update(self, value: Any) -> None:
        """What is published from now on."""
        self._message, self._times = self._filled(value)
        self._state = State()

    def stop(self) -> None:
        """Publish no more."""
        timer, self._timer = self._timer, None
        if timer is not None:
            timer.cancel()
            self._executor.create_task(self._node.destroy_timer, timer)

    def close(self) -> None:
        """Leave the topic; how it went is kept."""
        self.stop()
        with contextlib.suppress(Exception):  # ROS may have been shut down
            self._state = self.state
        self._is_closed = True
        self._executor.create_task(self._node.destroy_publisher, self._publisher)

    def _publish(self) -> None:
        message, times = self._message, self._times
        stamp(times, *self._node.get_clock().now().seconds_nanoseconds())
        try:
            self._publisher.publish(message)
            self._sent += 1
        except Exception as error:  # in the timer nobody else would say it
            self.fail(error)

    def _on_incompatible(self, event: Any) -> None:
        policy = qos_policy_name_from_kind(event.last_policy_kind).replace("_QOS_POLICY", "").lower()
        self._refused = f"; a subscription gets nothing, for it asks for another {policy}"
