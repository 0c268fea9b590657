"""Serialised messages, with what the middleware says of them: by the C++ module below rclpy, or more slowly.

In that module a subscription is no node's and no executor's. Beside it stands what does the same by public ways.
"""

from __future__ import annotations

import contextlib
import functools
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

from rclpy.context import Context
from rclpy.event_handler import QoSSubscriptionEventType, SubscriptionEventCallbacks
from rclpy.exceptions import InvalidHandle
from rclpy.executors import SingleThreadedExecutor
from rclpy.guard_condition import GuardCondition
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.type_support import check_is_valid_msg_type

from course_kit.ros.private_api import NotAsExpected, expect, going_on_without
from course_kit.ros.private_api.rmw_parts import SenderTaker

WAIT = 0.5  # seconds that one look for messages waits at most
BATCH = 5000  # messages that an executor brings in one look at most
IDLE = 5  # times that it has nothing to do before a look ends: now and then it only wakes itself
CPP = {
    "Subscription": ("take_message", "get_publisher_count", "destroy_when_not_in_use"),
    "EventHandle": ("take_event", "destroy_when_not_in_use"),
    "WaitSet": ("add_subscription", "add_event", "add_guard_condition", "clear_entities", "is_ready", "wait"),
}


class Ready(NamedTuple):
    """What one look has found of a taker: messages, news of lost ones, a publisher that does not fit."""

    messages: bool
    lost: bool
    refused: bool


class CppTaker:
    """A taker of the C++ module, which no executor knows."""

    def __init__(self, cpp: Any, node: Node, message_type: Any, topic: str, qos: QoSProfile) -> None:
        check_is_valid_msg_type(message_type)  # loads the type support
        with node.handle:
            self.subscription = cpp.Subscription(node.handle, message_type, topic, qos.get_c_qos_profile())
        kinds = QoSSubscriptionEventType
        with self.subscription:
            self.refused = cpp.EventHandle(self.subscription, kinds.RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS)
            self.missed = cpp.EventHandle(self.subscription, kinds.RCL_SUBSCRIPTION_MESSAGE_LOST)
        self.handles = (self.refused, self.missed, self.subscription)  # in the order in which they end
        self.take = functools.partial(self.subscription.take_message, message_type, True)
        self.take_missed = self.missed.take_event  # how many messages the middleware could not deliver
        self.take_refused = self.refused.take_event  # for which of its policies a publisher was last refused
        self._senders: SenderTaker | None = None

    def tell_senders(self) -> None:
        """Have the info of each message say its `publisher` (an id), from now on. Raises NotAsExpected."""
        self._senders = SenderTaker(self.subscription)
        self.take = self._senders.take  # type: ignore[assignment]

    def publisher_count(self) -> int:
        """How many publishers are matched; 0 once it is destroyed."""
        try:
            with self.subscription:
                return int(self.subscription.get_publisher_count())
        except InvalidHandle:
            return 0

    def destroy(self) -> None:
        """Have the middleware end it once nothing takes from it."""
        for handle in self.handles:
            handle.destroy_when_not_in_use()
        if self._senders is not None:
            self._senders.close()


class CppReception:
    """Waits for takers as an executor does, in one call for all. NotAsExpected if the C++ module is another one."""

    def __init__(self, context: Context) -> None:
        try:
            from rclpy.impl.implementation_singleton import rclpy_implementation
        except ImportError:
            raise NotAsExpected("rclpy has no impl.implementation_singleton here") from None
        self._cpp: Any = rclpy_implementation
        self._context = context
        expect("rclpy", self._cpp, *CPP)
        for name, methods in CPP.items():
            expect("rclpy", getattr(self._cpp, name), *methods)
        try:
            self._wait_set(0)
        except TypeError:
            raise NotAsExpected("rclpy's WaitSet() takes other arguments here") from None
        self._guard = GuardCondition(None, None, context)

    def _wait_set(self, takers: int) -> Any:
        return self._cpp.WaitSet(takers, 1, 0, 0, 0, 2 * takers, self._context.handle)

    def open(self, node: Node, message_type: Any, topic: str, qos: QoSProfile) -> CppTaker:
        """Make a taker, which no node lists."""
        return CppTaker(self._cpp, node, message_type, topic, qos)

    def wake(self) -> None:
        """End the look that waits now."""
        with contextlib.suppress(InvalidHandle):  # it is closed
            self._guard.trigger()

    @contextlib.contextmanager
    def looks_at(self, takers: Sequence[Any]) -> Iterator[Callable[[], list[Ready]]]:
        """While the block runs, the handles live: the wait set refers to them."""
        guard, wait_set = self._guard.handle, self._wait_set(len(takers))
        with contextlib.ExitStack() as in_use:
            for handle in (guard, wait_set, *(handle for taker in takers for handle in taker.handles)):
                in_use.enter_context(handle)

            add, add_event, is_ready = wait_set.add_subscription, wait_set.add_event, wait_set.is_ready

            def look() -> list[Ready]:
                wait_set.clear_entities()
                wait_set.add_guard_condition(guard)
                places = [(add(one.subscription), add_event(one.missed), add_event(one.refused)) for one in takers]
                wait_set.wait(int(WAIT * 1e9))
                return [Ready(*map(is_ready, ("subscription", "event", "event"), found)) for found in places]

            yield look

    def close(self) -> None:
        """End the guard condition that wakes it."""
        self._guard.destroy()


class PublicTaker:
    """A subscription of a node, whose callback keeps the messages until they are taken."""

    def __init__(self, node: Node, message_type: Any, topic: str, qos: QoSProfile) -> None:
        self._node = node
        self.kept: deque[tuple[bytes, dict[str, Any]]] = deque()
        self.missed: deque[Any] = deque(maxlen=1)  # what the middleware has last said of it
        self.refused: deque[Any] = deque(maxlen=1)
        self.take_missed, self.take_refused = self.missed.pop, self.refused.pop
        events = SubscriptionEventCallbacks(incompatible_qos=self.refused.append, message_lost=self.missed.append)
        receive: Any = self._on_message  # rclpy's type hints know of no second argument
        self._subscription = node.create_subscription(
            message_type, topic, receive, qos, event_callbacks=events, raw=True
        )

    def _on_message(self, message: bytes, info: dict[str, Any]) -> None:
        self.kept.append((message, info))

    def take(self) -> tuple[bytes, dict[str, Any]] | None:
        """The next message and its info; None if there is none."""
        return self.kept.popleft() if self.kept else None

    def tell_senders(self) -> None:
        """Raises NotAsExpected: rclpy does not tell who sent a message."""
        raise NotAsExpected("rclpy's subscriptions do not tell who sent a message")

    def publisher_count(self) -> int:
        """How many publishers are matched; 0 once it is destroyed."""
        try:
            return int(self._subscription.get_publisher_count())
        except InvalidHandle:
            return 0

    def destroy(self) -> None:
        """End the subscription."""
        self._node.destroy_subscription(self._subscription)


class PublicReception:
    """Has an executor call the takers' callbacks, for a node of its own."""

    def __init__(self, context: Context, name: str) -> None:
        self._node = Node(name, context=context, enable_rosout=False, start_parameter_services=False)
        self._executor = SingleThreadedExecutor(context=context)
        self._executor.add_node(self._node)

    def open(self, _: Node, message_type: Any, topic: str, qos: QoSProfile) -> PublicTaker:
        """Make a taker, which is a subscription of the node that the executor has."""
        return PublicTaker(self._node, message_type, topic, qos)

    def wake(self) -> None:
        """End the look that waits now."""
        self._executor.wake()

    @contextlib.contextmanager
    def looks_at(self, takers: Sequence[Any]) -> Iterator[Callable[[], list[Ready]]]:
        """While the block runs, callbacks are called in each look."""

        def look() -> list[Ready]:
            self._executor.spin_once(timeout_sec=WAIT)
            kept = idle = 0
            while idle < IDLE and kept < BATCH:
                self._executor.spin_once(timeout_sec=0)
                before, kept = kept, sum(len(taker.kept) for taker in takers)
                idle = idle + 1 if kept == before else 0
            return [Ready(*map(bool, (taker.kept, taker.missed, taker.refused))) for taker in takers]

        yield look

    def close(self) -> None:
        """End the executor and its node."""
        self._executor.shutdown(timeout_sec=1.0)
        self._node.destroy_node()


Taker = CppTaker | PublicTaker
Reception = CppReception | PublicReception


def reception(context: Context, name: str) -> Reception:
    """The way to serialised messages; a node that it may need is called `name`."""
    with going_on_without("recording and measuring go through an executor, which takes ten times the processor"):
        return CppReception(context)
    return PublicReception(context, name)
