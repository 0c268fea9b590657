"""Makes the rclpy calls that a notebook would trip over safe in it; everything else of rclpy stays as it is.

rclpy.init() may come twice and leaves Ctrl-C to the cell; rclpy.spin() and its relatives can be interrupted and
refuse a node that runs in the background; a blocking call in a callback fails at once in place of hanging; a callback
that cannot be called is refused where it is handed over; an answer to an action client is not lost when it is faster
than the cell that asked.
"""

from __future__ import annotations

import contextlib
import inspect
import math
import sys
import time
from collections.abc import Callable
from typing import Any

import rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.client import Client
from rclpy.executors import Executor
from rclpy.node import Node
from rclpy.task import Future

from course_kit.base import kernel
from course_kit.ros.causes.handed_over import wrong
from course_kit.ros.private_api import going_on_without, rclpy_action_parts, rclpy_parts
from course_kit.ros.spinning import NodeAlreadyRuns, action_answers, executors
from course_kit.ros.spinning import context as ros_context
from course_kit.ros.spinning.nodes import destroy

# A wait without a timeout cannot be interrupted in a kernel; many short ones can.
SLICE = 0.1
SAY_AFTER = 0.5  # seconds that rclpy.spin() has gone on when a cell says what that means
SPINS = (
    "rclpy.spin() keeps this cell busy, and no other cell runs, until you interrupt it (■), which ends the node: "
    "in a notebook write run(node) in its place, and the node runs in the background."
)


def install() -> None:
    """Put the guards in place, once; one that does not fit this rclpy is left out, and it is said what that means."""
    for owner, name, guard_of, without in GUARDS:
        with going_on_without(without):
            rclpy_parts.replace(owner, name, guard_of)
    with going_on_without("what an execute callback raises is seen in logs() alone"):
        rclpy_action_parts.report_executions(executors.report)
    action_answers.keep()


def _init(plain: Callable[..., None]) -> Callable[..., None]:
    def init(*, args: Any = None, context: Any = None, domain_id: int | None = None, **options: Any) -> None:
        """Start ROS; a second call for the default context does nothing."""
        if context is not None:
            plain(args=args, context=context, domain_id=domain_id, **options)
            return
        current = rclpy.get_default_context()
        if domain_id is not None and rclpy.ok() and current.get_domain_id() != domain_id:
            raise RuntimeError(
                f"ROS runs in this notebook already, in domain {current.get_domain_id()}, and a context cannot change "
                f"its domain. Call rclpy.shutdown() first, or rclpy.init(context=Context(), domain_id={domain_id})."
            )
        ros_context.start(args=args, domain_id=domain_id)

    return init


def _spin(node: Node, executor: Executor | None = None) -> None:
    chosen = executor or rclpy.get_global_executor()
    said = time.monotonic() + SAY_AFTER if kernel.in_kernel() else math.inf
    chosen.add_node(node)
    try:
        while chosen.context.ok():
            if time.monotonic() > said:
                print(SPINS, flush=True)
                said = math.inf
            chosen.spin_once(timeout_sec=SLICE)
    except BaseException:  # what would end a program, and the node with it
        chosen.remove_node(node)
        destroy(node)
        raise
    chosen.remove_node(node)


def _spin_until_future_complete(
    node: Node, future: Future, executor: Executor | None = None, timeout_sec: float | None = None
) -> None:
    chosen = executor or rclpy.get_global_executor()
    deadline = math.inf if timeout_sec is None or timeout_sec < 0 else time.monotonic() + timeout_sec
    future.add_done_callback(lambda _: chosen.wake())
    try:
        chosen.add_node(node)
        while chosen.context.ok() and not (future.done() or future.cancelled()):
            left = min(SLICE, deadline - time.monotonic())
            if left < 0:
                break
            chosen.spin_once(timeout_sec=left)
    finally:
        chosen.remove_node(node)


def _add_node(plain: Callable[..., bool]) -> Callable[..., bool]:
    def add_node(self: Executor, node: Node) -> bool:
        """Executor.add_node(), which would take a node away from the executor that runs it in the background."""
        owner = executors.executor_of(node)
        if owner is not None and owner is not self:
            name = node.get_fully_qualified_name()
            raise NodeAlreadyRuns(
                f"{name} already runs in the background, so it cannot be spun here too: a node belongs to one "
                f"executor. Wait for a result with wait_for(...), or call stop({name!r}) before you spin it yourself."
            )
        return plain(self, node)

    return add_node


def _refusing(name: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """A blocking call that fails at once where it could only hang: in a callback, without a timeout."""

    def guard_of(method: Callable[..., Any]) -> Callable[..., Any]:
        def guarded(self: Any, *args: Any, **kwargs: Any) -> Any:
            waits_for_ever = kwargs.get("timeout_sec") is None and len(args) < 2
            if waits_for_ever and _belongs_to_this_thread(self):
                executors.refuse_in_callback(name)
            return method(self, *args, **kwargs)

        return guarded

    return guard_of


def _belongs_to_this_thread(client: Any) -> bool:
    """Return True if the answer to a client would be delivered by the executor whose callback runs now."""
    current = executors.current()
    nodes = current.executor.get_nodes() if current is not None else []
    return any(client in (*node.clients, *node.waitables) for node in nodes)


def _looking_at_arguments(taker: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """A function that looks at what it is given before it takes it: an executor would find out only later."""

    def guard_of(plain: Callable[..., Any]) -> Callable[..., Any]:
        signature = inspect.signature(plain)

        def guarded(self: Any, *args: Any, **kwargs: Any) -> Any:
            told = ""
            by_rclpy = str(sys._getframe(1).f_globals.get("__name__")).startswith("rclpy.")  # create_rate() means None
            with contextlib.suppress(TypeError):  # too few or too many, which the function itself says
                told = "" if by_rclpy else wrong(taker, signature.bind(self, *args, **kwargs).arguments)
            if told:
                raise TypeError(told)
            return plain(self, *args, **kwargs)

        return guarded

    return guard_of


LATE = "a callback that cannot be called, or a QoS that is none, is seen only later, if at all"
# Whose function, its name, what makes the guard of it, and what holds where that cannot be put in place.
GUARDS: tuple[tuple[Any, str, Callable[[Any], Callable[..., Any]], str], ...] = (
    (rclpy, "init", _init, "a second rclpy.init() is an error, and Ctrl-C ends ROS"),
    (rclpy, "spin", lambda _: _spin, "a cell with rclpy.spin() cannot be interrupted"),
    (
        rclpy,
        "spin_until_future_complete",
        lambda _: _spin_until_future_complete,
        "a cell with rclpy.spin_until_future_complete() cannot be interrupted",
    ),
    (Executor, "add_node", _add_node, "a node that runs in the background can be spun in a cell too, and stands still"),
    (Client, "call", _refusing("client.call()"), "client.call() in a callback hangs"),
    (Node, "create_timer", _looking_at_arguments("create_timer"), LATE),
    (Node, "create_subscription", _looking_at_arguments("create_subscription"), LATE),
    (Node, "create_publisher", _looking_at_arguments("create_publisher"), LATE),
    (Node, "create_service", _looking_at_arguments("create_service"), LATE),
    (ActionServer, "__init__", _looking_at_arguments("ActionServer"), LATE),
    (ActionClient, "send_goal", _refusing("send_goal()"), "send_goal() in a callback hangs"),
)
