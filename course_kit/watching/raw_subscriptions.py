"""Subscriptions to serialised messages, drained by one thread of their own, apart from every executor.

rclpy's executors spend 50 to 500 microseconds of Python on each message. Here a thread waits on all subscriptions at
once and then takes whatever has come, message after message: a few microseconds each, and after a stall (a cell that
keeps the interpreter busy) one look catches up with all that the middleware kept meanwhile.
"""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable, Iterable
from typing import Any

from rclpy.event_handler import QoSSubscriptionEventType
from rclpy.guard_condition import GuardCondition
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSPolicyKind, QoSProfile, ReliabilityPolicy
from rclpy.type_support import check_is_valid_msg_type

from course_kit.watching import topics

Callback = Callable[[bytes, dict[str, Any]], None]
Refused = Callable[[QoSPolicyKind], None]

PAUSE = 0.001  # seconds: many messages for each look, at most this much delay
BATCH = 5000  # messages taken from one subscription before the next one has its turn
WAIT_NS = 500_000_000


class RawSubscription:
    """One subscription; `callback(serialised message, message info)` is called in the watching thread.

    The info is rclpy's dictionary; its `received_timestamp` (nanoseconds since the epoch) is taken by the middleware
    when a message arrives and stays true when Python is late.
    """

    def __init__(
        self,
        watcher: Watcher,
        topic: str,
        message_type: Any,
        qos: QoSProfile,
        callback: Callback,
        on_refused: Refused | None = None,
    ) -> None:
        """When a publisher offers less than `qos`, `on_refused(policy)` is called; without it, less is asked for."""
        self.topic = topic
        self.message_type = message_type
        self.type = topics.type_name(message_type)
        self.lost = 0  # messages that the middleware says it could not deliver
        self.callback = callback
        self._on_refused = on_refused
        self.closing = False
        self.closed = threading.Event()
        self._watcher = watcher
        self._qos = qos
        check_is_valid_msg_type(message_type)  # loads the type support
        self._open()

    def __repr__(self) -> str:
        return f"<subscription to {self.topic} [{self.type}], {'open' if self.is_open else 'closed'}>"

    @property
    def is_open(self) -> bool:
        """Whether messages still come: until close(), or until ROS is shut down."""
        return not (self.closing or self.closed.is_set())

    @property
    def publisher_count(self) -> int:
        """How many publishers are matched."""
        try:
            with self._handle:
                return int(self._handle.get_publisher_count())
        except _rclpy.InvalidHandle:
            return 0

    def close(self, wait: bool = True) -> None:
        """End the subscription; what has arrived by now is still delivered. Safe from every thread, and twice."""
        self.closing = True
        self._watcher.wake()
        if wait and not self._watcher.is_current_thread():
            self.closed.wait(2.0)

    # What follows is called by the watcher.

    def _open(self) -> None:
        node = self._watcher.node
        try:
            with node.handle:
                handle = _rclpy.Subscription(node.handle, self.message_type, self.topic, self._qos.get_c_qos_profile())
        except _rclpy.RCLError:
            if self.type in dict(node.get_topic_names_and_types()).get(self.topic, [self.type]):
                raise
            raise TypeError(
                f"{self.topic} is used in this process with another type than {self.type}, and a topic has one type"
            ) from None
        kinds = QoSSubscriptionEventType
        with handle:
            refused = _rclpy.EventHandle(handle, kinds.RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS)
            missed = _rclpy.EventHandle(handle, kinds.RCL_SUBSCRIPTION_MESSAGE_LOST)
        self._handle, self._refused, self._missed = handle, refused, missed
        self._handles = (refused, missed, handle)  # in the order in which they end
        self._lost_before = self.lost

    def finish(self) -> None:
        """Destroy it for good and release who waits for that."""
        _destroy(self._handles)
        self.closed.set()

    @contextlib.contextmanager
    def in_use(self) -> Any:
        """Keeps the handles alive while a wait set refers to them."""
        with self._handle, self._refused, self._missed:
            yield

    def add_to(self, wait_set: Any) -> tuple[int, int, int]:
        """Add the subscription and its events; return their places in the wait set."""
        return (
            wait_set.add_subscription(self._handle),
            wait_set.add_event(self._refused),
            wait_set.add_event(self._missed),
        )

    def drain(self, on_error: Callable[[Exception], None], limit: int = BATCH) -> None:
        """Hand over what has arrived, `limit` messages at most."""
        take, message_type, callback = self._handle.take_message, self.message_type, self.callback
        for _ in range(limit):
            taken = take(message_type, True)
            if taken is None:
                return
            try:
                callback(*taken)
            except Exception as error:  # one bad callback must not end the others' messages
                on_error(error)

    def count_lost(self) -> None:
        """Add what the middleware says it has lost."""
        self.lost = self._lost_before + int(self._missed.take_event().total_count)

    def follow_publisher(self, on_error: Callable[[Exception], None]) -> None:
        """A publisher offers less than this subscription asks for: say so, or ask for less, then it delivers too."""
        policy = self._refused.take_event().last_policy_kind
        if self._on_refused is not None:
            self._on_refused(policy)
            return
        if policy == QoSPolicyKind.RELIABILITY:
            self._qos.reliability = ReliabilityPolicy.BEST_EFFORT
        elif policy == QoSPolicyKind.DURABILITY:
            self._qos.durability = DurabilityPolicy.VOLATILE
        else:
            return
        self.drain(on_error)
        before = self._handles
        try:
            self._open()
        except Exception as error:  # what came until now goes on coming, of this topic and of the others
            on_error(error)
        else:
            _destroy(before)


def _destroy(handles: Iterable[Any]) -> None:
    """Have the middleware end a subscription once nothing takes from it."""
    for handle in handles:
        handle.destroy_when_not_in_use()


class Watcher:
    """The thread that drains the raw subscriptions of a node which no executor knows them of."""

    def __init__(self, node: Node, on_error: Callable[[Exception], None]) -> None:
        self.node = node
        self._on_error = on_error
        self._context = node.context
        self._stopping = False
        self._lock = threading.Lock()
        self._subscriptions: tuple[RawSubscription, ...] = ()
        self._guard = GuardCondition(None, None, node.context)
        self._context.on_shutdown(self.wake)
        self._thread = threading.Thread(target=self._run, name="course_kit watcher", daemon=True)
        self._thread.start()

    @property
    def is_alive(self) -> bool:
        """Whether the thread runs."""
        return self._thread.is_alive()

    def is_current_thread(self) -> bool:
        """Whether this is the watching thread."""
        return threading.current_thread() is self._thread

    def subscribe(
        self, topic: str, message_type: Any, qos: QoSProfile, callback: Callback, on_refused: Refused | None = None
    ) -> RawSubscription:
        """Open a subscription; its callback gets (bytes, message info)."""
        subscription = RawSubscription(self, topic, message_type, qos, callback, on_refused)
        with self._lock:
            self._subscriptions = (*self._subscriptions, subscription)
        self.wake()
        return subscription

    def wake(self) -> None:
        """Have the thread look at its subscriptions anew."""
        with contextlib.suppress(Exception):  # the guard condition goes with the thread
            self._guard.trigger()

    def stop(self) -> None:
        """End the thread and every subscription."""
        self._stopping = True
        self.wake()
        if not self.is_current_thread():
            self._thread.join(2.0)

    def _run(self) -> None:
        try:
            while self._goes_on():
                self._watch(self._subscriptions)
                self._remove_closed()
        except Exception as error:
            if self._goes_on():
                self._on_error(error)
        finally:
            self._stopping = True
            with self._lock:
                remaining, self._subscriptions = self._subscriptions, ()
            for subscription in remaining:
                subscription.finish()
            self._guard.destroy()

    def _goes_on(self) -> bool:
        return not self._stopping and self._context.ok()

    def _watch(self, subscriptions: tuple[RawSubscription, ...]) -> None:
        """Deliver messages of these subscriptions until one is added, closed or must ask for another QoS."""
        count = len(subscriptions)
        refused: RawSubscription | None = None
        with contextlib.ExitStack() as in_use:
            for subscription in subscriptions:
                in_use.enter_context(subscription.in_use())
            wait_set = _rclpy.WaitSet(count, 1, 0, 0, 0, 2 * count, self._context.handle)
            in_use.enter_context(self._guard.handle)
            in_use.enter_context(wait_set)
            while refused is None and self._subscriptions is subscriptions and self._goes_on():
                if any(s.closing for s in subscriptions):
                    break
                wait_set.clear_entities()
                wait_set.add_guard_condition(self._guard.handle)
                places = [(s, *s.add_to(wait_set)) for s in subscriptions]
                wait_set.wait(WAIT_NS)
                for subscription, place, refusal, loss in places:
                    if wait_set.is_ready("subscription", place):
                        subscription.drain(self._on_error)
                    if wait_set.is_ready("event", loss):
                        subscription.count_lost()
                    if wait_set.is_ready("event", refusal):
                        refused = subscription
                time.sleep(PAUSE)
        if refused is not None:
            refused.follow_publisher(self._on_error)

    def _remove_closed(self) -> None:
        with self._lock:
            closed = [s for s in self._subscriptions if s.closing]
            self._subscriptions = tuple(s for s in self._subscriptions if not s.closing)
        for subscription in closed:
            with subscription.in_use():
                subscription.drain(self._on_error, limit=topics.DEPTH)
            subscription.finish()
