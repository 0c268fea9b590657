"""One node in step with a bag: each message is sent when the callbacks of the one before have returned.

The node's class is given a base under it that runs it in the context of the replay and on its clock, counts the
callbacks of its subscriptions, and hands over what it publishes at the moment at which it does.
"""

from __future__ import annotations

import contextlib
import functools
import inspect
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import rclpy
from rcl_interfaces.msg import Log
from rclpy.clock import ClockType
from rclpy.executors import Executor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import serialize_message
from rclpy.time import Time
from rosgraph_msgs.msg import Clock

from course_kit.base.polling import wait_until
from course_kit.lab.bags import qos as bag_qos
from course_kit.ros.private_api.rclpy_parts import fast_executor, is_fast
from course_kit.ros.spinning import context, executors
from course_kit.ros.spinning.nodes import WITHOUT_DESCRIPTIONS, destroy, quiet_node
from course_kit.ros.subscriptions import topics

OF_EVERY_NODE = ("/parameter_events", "/rosout", "/clock")
DOMAINS = 100  # 0 to 99: those whose ports every system leaves free
TICK = 0.05  # seconds that one look for something to do waits at most
Keep = Callable[[str, Any, int, bytes], None]  # topic, type, nanoseconds, serialised message


@dataclass(eq=False)
class _Subscribed:
    """A subscription of the node: how many messages were sent to it, and how many of its callbacks returned."""

    subscription: Any = None
    sent: int = 0
    done: int = 0


class LockStep:
    """Runs one node on the messages of a bag, in a ROS context that speaks with no other process. close() it."""

    def __init__(self, start: int, keep: Keep, timeout: float) -> None:
        """`start` is the bag's, in nanoseconds; `timeout` in seconds is given to each callback."""
        context.start()  # so that what the notebook's context sets for all, such as where logs go, is set
        own = context.separate((rclpy.get_default_context().get_domain_id() + 1) % DOMAINS, "OFF")
        self.context, self.now = own, start
        self.logged: list[Log] = []
        self.node: Node | None = None
        self._keep, self._timeout = keep, timeout
        self._subscribed: list[_Subscribed] = []
        self._publishers: dict[str, Publisher] = {}
        self._executor: Executor = fast_executor(own)
        self._player = quiet_node("replay", own)
        latched = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self._player.create_subscription(Log, "/rosout", self.logged.append, latched)
        self._clock = self._player.create_publisher(Clock, "/clock", 10)
        self._executor.add_node(self._player)

    def close(self) -> None:
        """End the node and everything that was made for it."""
        for node in (self.node, self._player):
            if node is not None:
                with contextlib.suppress(Exception):
                    self._executor.remove_node(node)
                destroy(node)
        self._executor.shutdown(timeout_sec=1.0)
        self.context.try_shutdown()

    def make(self, node_class: type[Node], args: tuple[Any, ...], kwargs: dict[str, Any]) -> None:
        """Make the node, with the bag's clock at its start when its constructor goes on."""
        self.node = _with_base(node_class, _base(self))(*args, **kwargs)
        self._suit()

    def _suit(self) -> None:
        """Change to the slower executor where the fast one would not do.

        With two timers, for of those that are due at the same time it runs any first; with `async def` callbacks,
        since it does not look at callback groups.
        """
        assert self.node is not None
        if is_fast(self._executor) and (len(self._timers()) > 1 or executors.needs_usual_executor(self.node)):
            slower = SingleThreadedExecutor(context=self.context)
            for one in (self._player, self.node):
                self._executor.remove_node(one)
                slower.add_node(one)
            self._executor.shutdown(timeout_sec=1.0)
            self._executor = slower

    def begin(self, node: Node) -> None:
        """A node is there, as far as rclpy's constructor makes it: set its clock."""
        self.node = node
        self._executor.add_node(node)
        self._until(self._clock.get_subscription_count, "the node's clock", topics.MISMATCH_TIMEOUT)
        self._set_clock(self.now)

    def subscribes_to(self) -> dict[str, str]:
        """The topics that the node subscribes to now, and their types."""
        return {
            one.subscription.topic_name: topics.type_name(one.subscription.msg_type)
            for one in self._there()
            if one.subscription.topic_name not in OF_EVERY_NODE
        }

    def send(self, connection: Any, nanoseconds: int, data: bytes) -> None:
        """Bring the clock to the time of a message of the bag, send it, and let the node do all that follows."""
        self.advance(nanoseconds)
        receivers = [one for one in self._there() if one.subscription.topic_name == connection.topic]
        if not receivers:
            return
        publisher = self._publisher(connection, len(receivers))
        for one in receivers:
            one.sent += 1
        publisher.publish(bytes(data))
        self._until(self._is_settled, f"the callback of {connection.topic}")

    def advance(self, nanoseconds: int) -> None:
        """Bring the clock to a time; timers fire on the way, each when the clock is at its time."""
        self._suit()
        while True:
            due = [(self.now + max(0, left), timer) for timer in self._timers() if (left := _left(timer)) is not None]
            first, timer = min(due, key=lambda one: one[0], default=(nanoseconds + 1, None))
            if timer is None or first > nanoseconds:
                break
            self._set_clock(first)
            self._until(functools.partial(_has_fired, timer), "the callback of a timer")
            self._until(self._is_settled, "the callback of what a timer published")
        if nanoseconds > self.now:
            self._set_clock(nanoseconds)

    def take_logs(self) -> list[Log]:
        """What the node has logged; waits for the last lines to come."""
        before = -1
        while before < len(self.logged):
            before = len(self.logged)
            self._spin(TICK)
        return self.logged

    def _timers(self) -> list[Any]:
        timers = [timer for timer in self.node.timers if timer.clock.clock_type == ClockType.ROS_TIME]  # type: ignore
        if any(timer.timer_period_ns == 0 for timer in timers):
            raise ValueError("the node has a timer with a period of 0, which fires for ever: give it a period")
        return timers

    def _set_clock(self, nanoseconds: int) -> None:
        assert self.node is not None
        clock = self.node.get_clock()
        self.now = nanoseconds
        self._clock.publish(Clock(clock=Time(nanoseconds=nanoseconds).to_msg()))
        self._until(lambda: clock.now().nanoseconds == nanoseconds, "the node's clock")

    def _there(self) -> list[_Subscribed]:
        subscriptions = list(self.node.subscriptions) if self.node is not None else []
        return [one for one in self._subscribed if one.subscription in subscriptions]

    def _is_settled(self) -> bool:
        return all(one.done >= one.sent for one in self._there())

    def _publisher(self, connection: Any, receivers: int) -> Publisher:
        topic = connection.topic
        if topic not in self._publishers:
            profile = bag_qos.to_offer(connection.ext.offered_qos_profiles)
            message_type = topics.message_class(connection.msgtype)
            self._publishers[topic] = self._player.create_publisher(message_type, topic, profile)
        publisher = self._publishers[topic]
        if not wait_until(
            lambda: publisher.get_subscription_count() >= receivers, topics.MISMATCH_TIMEOUT, TICK, self._spin
        ):
            raise ValueError(
                f"the node does not get {topic} as it was recorded: its subscription's QoS asks for more than "
                f"the publisher offered (`ros2 topic info -v` shows both)"
            )
        return publisher

    def _until(self, condition: Callable[[], Any], what: str, timeout: float | None = None) -> None:
        """Run callbacks until a condition holds; what one raises comes out here."""
        limit = self._timeout if timeout is None else timeout
        if not wait_until(condition, limit, TICK, self._spin):
            raise TimeoutError(f"{what} did not return within {limit:g} s, in the bag at {self.now * 1e-9:.3f} s")

    def _spin(self, seconds: float) -> None:
        self._executor.spin_once(timeout_sec=seconds)

    # What the base under the node's class calls.

    def subscribed(self, make: Callable[[Any], Any], callback: Callable[..., Any]) -> Any:
        """Make a subscription whose callback is counted."""
        one = _Subscribed()
        one.subscription = make(_counted(callback, one))
        self._subscribed.append(one)
        return one.subscription

    def publishes(self, publisher: Publisher) -> Publisher:
        """Have what goes through a publisher kept."""
        if publisher.topic_name in OF_EVERY_NODE:
            return publisher
        plain = publisher.publish

        @functools.wraps(plain)
        def publish(message: Any) -> None:
            data = message if isinstance(message, bytes) else serialize_message(message)
            self._keep(publisher.topic_name, publisher.msg_type, self.now, data)
            for one in self._there():
                if one.subscription.topic_name == publisher.topic_name:
                    one.sent += 1
            plain(message)

        setattr(publisher, "publish", publish)  # noqa: B010  (mypy would take it for a mistake)
        return publisher


def _left(timer: Any) -> int | None:
    """Nanoseconds until a timer fires; None for one that was cancelled."""
    return None if timer.is_canceled() else timer.time_until_next_call()


def _has_fired(timer: Any) -> bool:
    left = _left(timer)
    return left is None or left > 0


def _counted(callback: Callable[..., Any], one: _Subscribed) -> Callable[..., Any]:
    if inspect.iscoroutinefunction(callback):

        @functools.wraps(callback)
        async def counted_async(*args: Any) -> None:
            await callback(*args)
            one.done += 1

        return counted_async

    @functools.wraps(callback)
    def counted(*args: Any) -> None:
        callback(*args)
        one.done += 1

    return counted


def _with_base(node_class: type[Node], base: type[Node]) -> type[Node]:
    """A class of the same name with `base` between it and Node."""
    bases = (base,) if node_class is Node else (node_class, base)
    return type(node_class.__name__, bases, {"__module__": node_class.__module__, "__doc__": node_class.__doc__})


def _base(steps: LockStep) -> type[Node]:
    """The base that stands between a node's class and rclpy's Node."""

    class Stepped(Node):
        def __init__(self, node_name: str, *args: Any, **kwargs: Any) -> None:
            given = kwargs.pop("parameter_overrides", None) or []
            simulated = Parameter("use_sim_time", value=True)
            kwargs["parameter_overrides"] = [*given, simulated, *WITHOUT_DESCRIPTIONS]
            kwargs.setdefault("start_parameter_services", False)  # nobody calls them, and each look asks them all
            super().__init__(node_name, *args, **{**kwargs, "context": steps.context})
            steps.begin(self)

        def create_subscription(self, msg_type: Any, topic: Any, callback: Any, *args: Any, **kwargs: Any) -> Any:
            make = super().create_subscription
            return steps.subscribed(lambda counted: make(msg_type, topic, counted, *args, **kwargs), callback)

        def create_publisher(self, *args: Any, **kwargs: Any) -> Any:
            return steps.publishes(super().create_publisher(*args, **kwargs))

    return Stepped
