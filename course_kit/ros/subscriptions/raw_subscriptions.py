"""Subscriptions to serialised messages, drained by one thread of their own, apart from every executor.

rclpy's executors spend 50 to 500 microseconds of Python on each message. Here a thread waits on all subscriptions at
once and then takes whatever has come, message after message: a few microseconds each, and after a stall (a cell that
keeps the interpreter busy) one look catches up with all that the middleware kept meanwhile.
"""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable
from typing import Any

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSPolicyKind, QoSProfile, ReliabilityPolicy

from course_kit.base.shutdown.signals import whole
from course_kit.ros.private_api import going_on_without
from course_kit.ros.private_api.rclpy_message_parts import Taker, reception
from course_kit.ros.subscriptions import topics

Callback = Callable[[bytes, dict[str, Any]], None]
Refused = Callable[[QoSPolicyKind], None]

PAUSE = 0.001  # seconds: many messages for each look, at most this much delay
BATCH = 5000  # messages taken from one subscription before the next one has its turn


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
        self._open()

    def __repr__(self) -> str:
        return f"<subscription to {self.topic} [{self.type}], {'open' if self.is_open else 'closed'}>"

    @property
    def is_open(self) -> bool:
        """True if messages still come: until close(), or until ROS is shut down."""
        return not (self.closing or self.closed.is_set())

    @property
    def publisher_count(self) -> int:
        """How many publishers are matched."""
        return self.taker.publisher_count()

    def close(self, wait: bool = True) -> None:
        """End the subscription; what has arrived by now is still delivered. Safe from every thread, and twice."""
        self.closing = True
        self._watcher.wake()
        if wait and not self._watcher.is_current_thread():
            self.closed.wait(2.0)

    # What follows is called by the watcher.

    def _open(self) -> None:
        node, reception = self._watcher.node, self._watcher.reception
        try:
            self.taker: Taker = reception.open(node, self.message_type, self.topic, self._qos)
            if self._watcher.with_senders:
                with going_on_without("messages of other nodes than the answer's count in checks"):
                    self.taker.tell_senders()
        except RuntimeError:
            if self.type in dict(node.get_topic_names_and_types()).get(self.topic, [self.type]):
                raise
            raise TypeError(
                f"{self.topic} is used in this process with another type than {self.type}, and a topic has one type"
            ) from None
        self._lost_before = self.lost

    def finish(self) -> None:
        """Destroy it for good and release who waits for that."""
        self.taker.destroy()
        self.closed.set()

    def drain(self, on_error: Callable[[Exception], None], limit: int = BATCH) -> None:
        """Hand over what has arrived, `limit` messages at most."""
        take, callback = self.taker.take, self.callback
        for _ in range(limit):
            taken = take()
            if taken is None:
                return
            try:
                callback(*taken)
            except Exception as error:  # one bad callback must not end the others' messages
                on_error(error)

    def count_lost(self) -> None:
        """Add what the middleware says it has lost."""
        self.lost = self._lost_before + int(self.taker.take_missed().total_count)

    def follow_publisher(self, on_error: Callable[[Exception], None]) -> None:
        """A publisher offers less than this subscription asks for: say so, or ask for less, then it delivers too."""
        policy = self.taker.take_refused().last_policy_kind
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
        before = self.taker
        try:
            self._open()
        except Exception as error:  # what came until now goes on coming, of this topic and of the others
            on_error(error)
        else:
            before.destroy()


class Watcher:
    """The thread that drains the raw subscriptions of a node which no executor knows them of."""

    def __init__(self, node: Node, on_error: Callable[[Exception], None], with_senders: bool = False) -> None:
        """`with_senders`: the info has the id of a message's `publisher`, and no sequence number."""
        self.node = node
        self.with_senders = with_senders
        self._on_error = on_error
        self._context = node.context
        self._stopping = False
        self._lock = threading.Lock()
        self._subscriptions: tuple[RawSubscription, ...] = ()
        self.reception = reception(node.context, f"_{node.get_name()}_reception")
        self._context.on_shutdown(self.wake)
        self._thread = threading.Thread(target=self._run, name="course_kit watcher", daemon=True)
        self._thread.start()

    @property
    def is_alive(self) -> bool:
        """True if the thread runs."""
        return self._thread.is_alive()

    def is_current_thread(self) -> bool:
        """Return True if this is the watching thread."""
        return threading.current_thread() is self._thread

    def subscribe(
        self, topic: str, message_type: Any, qos: QoSProfile, callback: Callback, on_refused: Refused | None = None
    ) -> RawSubscription:
        """Open a subscription; its callback gets (bytes, message info)."""

        def opened() -> RawSubscription:
            subscription = RawSubscription(self, topic, message_type, qos, callback, on_refused)
            with self._lock:
                self._subscriptions = (*self._subscriptions, subscription)
            self.wake()
            return subscription

        return whole(opened, RawSubscription.close)

    def wake(self) -> None:
        """Have the thread look at its subscriptions anew."""
        with contextlib.suppress(Exception):  # it goes with the thread
            self.reception.wake()

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
            self.reception.close()

    def _goes_on(self) -> bool:
        return not self._stopping and self._context.ok()

    def _watch(self, subscriptions: tuple[RawSubscription, ...]) -> None:
        """Deliver messages of these subscriptions until one is added, closed or must ask for another QoS."""
        refused: RawSubscription | None = None
        with self.reception.looks_at([one.taker for one in subscriptions]) as look:
            while refused is None and self._subscriptions is subscriptions and self._goes_on():
                for subscription, ready in zip(subscriptions, look(), strict=True):
                    if ready.messages:
                        subscription.drain(self._on_error)
                    if ready.lost:
                        subscription.count_lost()
                    if ready.refused:
                        refused = subscription
                if any(s.closing for s in subscriptions):
                    break
                time.sleep(PAUSE)
        if refused is not None:
            refused.follow_publisher(self._on_error)

    def _remove_closed(self) -> None:
        with self._lock:
            closed = [s for s in self._subscriptions if s.closing]
            self._subscriptions = tuple(s for s in self._subscriptions if not s.closing)
        for subscription in closed:
            subscription.drain(self._on_error, limit=topics.DEPTH)
            subscription.finish()
