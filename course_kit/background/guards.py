"""Makes the rclpy calls that a notebook would trip over safe in it; everything else of rclpy stays as it is.

rclpy.init() may come twice and leaves Ctrl-C to the cell; rclpy.spin() and its relatives can be interrupted and
refuse a node that runs in the background; a blocking call in a callback fails at once in place of hanging; an answer
to an action client is not lost when it is faster than the cell that asked.
"""

from __future__ import annotations

import functools
import time
from collections.abc import Callable
from typing import Any

import rclpy
from rclpy.action import ActionClient
from rclpy.client import Client
from rclpy.executors import Executor
from rclpy.node import Node
from rclpy.task import Future

from course_kit.spinning import NodeAlreadyRuns, action_answers, executors
from course_kit.spinning import context as ros_context

# A wait without a timeout cannot be interrupted in a kernel; many short ones can.
SLICE = 0.1


def install() -> None:
    """Put the guards in place, once."""
    if getattr(rclpy.init, "guarded", False):
        return
    guards: dict[str, Any] = {
        "init": _init,
        "spin": _spin,
        "spin_until_future_complete": _spin_until_future_complete,
    }
    for name, guard in guards.items():
        plain = getattr(rclpy, name)
        functools.update_wrapper(guard, plain)
        guard.guarded = True
        setattr(rclpy, name, guard)
    setattr(Executor, "add_node", _add_node)  # noqa: B010  (mypy would take it for a mistake)
    setattr(Client, "call", _refusing(Client.call, "client.call()"))  # noqa: B010
    setattr(ActionClient, "send_goal", _refusing(ActionClient.send_goal, "send_goal()"))  # noqa: B010
    action_answers.keep()


_plain_init = rclpy.init


def _init(*, args: Any = None, context: Any = None, domain_id: int | None = None, **options: Any) -> None:
    """Start ROS; a second call for the default context does nothing."""
    if context is not None:
        _plain_init(args=args, context=context, domain_id=domain_id, **options)
        return
    current = rclpy.get_default_context()
    if domain_id is not None and rclpy.ok() and current.get_domain_id() != domain_id:
        raise RuntimeError(
            f"ROS runs in this notebook already, in domain {current.get_domain_id()}, and a context cannot change "
            f"its domain. Call rclpy.shutdown() first, or rclpy.init(context=Context(), domain_id={domain_id})."
        )
    ros_context.start(args=args, domain_id=domain_id)


def _spin(node: Node, executor: Executor | None = None) -> None:
    chosen = executor or rclpy.get_global_executor()
    try:
        chosen.add_node(node)
        while chosen.context.ok():
            chosen.spin_once(timeout_sec=SLICE)
    finally:
        chosen.remove_node(node)


def _spin_until_future_complete(
    node: Node, future: Future, executor: Executor | None = None, timeout_sec: float | None = None
) -> None:
    chosen = executor or rclpy.get_global_executor()
    forever = timeout_sec is None or timeout_sec < 0
    deadline = time.monotonic() + (0.0 if timeout_sec is None else timeout_sec)
    future.add_done_callback(lambda _: chosen.wake())
    try:
        chosen.add_node(node)
        while chosen.context.ok() and not (future.done() or future.cancelled()):
            left = SLICE if forever else min(SLICE, deadline - time.monotonic())
            if left < 0:
                break
            chosen.spin_once(timeout_sec=left)
    finally:
        chosen.remove_node(node)


def _add_node(self: Executor, node: Node) -> bool:
    """Executor.add_node(), which would take a node away from the executor that runs it in the background."""
    owner = executors.executor_of(node)
    if owner is not None and owner is not self:
        name = node.get_fully_qualified_name()
        raise NodeAlreadyRuns(
            f"{name} already runs in the background, so it cannot be spun here too: a node belongs to one executor. "
            f"Wait for a result with wait_for(...), or call stop({name!r}) before you spin it yourself."
        )
    return _plain_add_node(self, node)


_plain_add_node = Executor.add_node


def _refusing(method: Callable[..., Any], name: str) -> Callable[..., Any]:
    """A blocking call that fails at once where it could only hang: in a callback, without a timeout."""

    @functools.wraps(method)
    def guarded(self: Any, *args: Any, **kwargs: Any) -> Any:
        waits_for_ever = kwargs.get("timeout_sec") is None and len(args) < 2
        if waits_for_ever and _belongs_to_this_thread(self):
            executors.refuse_in_callback(name)
        return method(self, *args, **kwargs)

    return guarded


def _belongs_to_this_thread(client: Any) -> bool:
    """Whether the answer to a client would be delivered by the executor whose callback runs now."""
    current = executors.current()
    if current is None:
        return False
    nodes = current.executor.get_nodes()
    return getattr(client, "_node", None) in nodes or any(client in node.clients for node in nodes)
