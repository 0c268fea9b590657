"""The callbacks of a node that runs, read from it: their groups, and the threads of its executor."""

from __future__ import annotations

import functools
import inspect
import os
from collections.abc import Iterator
from typing import Any

from rclpy.executors import Executor
from rclpy.node import Node

from course_kit.lab.callbacks.callback_groups import Callback, Execution, Group
from course_kit.ros.private_api import NotAsExpected, going_on_without
from course_kit.ros.private_api.rclpy_parts import thread_count
from course_kit.ros.spinning.executors import executor_of
from course_kit.ros.spinning.nodes import actions_of


def execution_of(node: Node) -> Execution:
    """The groups of a node's callbacks, in the order of their first callback, and the executor that has the node."""
    groups: dict[Any, list[Callback]] = {}
    others: dict[Any, int] = {}
    for group, callback in _callbacks(node):
        groups.setdefault(group, [])
        if callback is None:
            others[group] = others.get(group, 0) + 1
        else:
            groups[group].append(callback)
    default = node.default_callback_group
    read = [_group(g, g is default, tuple(callbacks), others.get(g, 0)) for g, callbacks in groups.items()]
    executor = executor_of(node) or node.executor
    name = "" if executor is None else type(executor).__name__
    threads = 0 if executor is None else _threads(executor)
    # A group of rclpy's own alone is no choice of the author's; but without any of theirs it is all that there is.
    kept = [group for group in read if group.callbacks] or read
    return Execution(node.get_fully_qualified_name(), name, threads, tuple(kept))


def _threads(executor: Executor) -> int:
    try:
        return thread_count(executor)
    except NotAsExpected as error:
        with going_on_without("the picture shows one thread for each core"):
            raise error
        return len(os.sched_getaffinity(0))


def _group(group: Any, is_default: bool, callbacks: tuple[Callback, ...], others: int) -> Group:
    is_reentrant = type(group).__name__ == "ReentrantCallbackGroup"
    return Group(is_reentrant, is_default, callbacks, others)


def _callbacks(node: Node) -> Iterator[tuple[Any, Callback | None]]:
    """The group of each callback and what it is; None for those that rclpy gives every node."""
    for timer in node.timers:
        if not _is_of_rclpy(timer.callback):
            seconds = timer.timer_period_ns * 1e-9
            yield timer.callback_group, Callback("timer", f"every {seconds:g} s", _name(timer.callback))
    for subscription in node.subscriptions:
        of_rclpy = _is_of_rclpy(subscription.callback)
        heard = Callback("subscription", f"message on {subscription.topic_name}", _name(subscription.callback))
        yield subscription.callback_group, None if of_rclpy else heard
    for service in node.services:
        served = Callback("service", f"request of {service.service_name}", _name(service.callback))
        yield service.callback_group, None if _is_of_rclpy(service.callback) else served
    for client in node.clients:
        yield client.callback_group, Callback("client", f"response of {client.service_name}", "complete the future")
    for action in actions_of(node):
        kind = "action client" if type(action).__name__ == "ActionClient" else "action server"
        yield action.callback_group, Callback(kind, "goals", "what rclpy does for them")


def _is_of_rclpy(callback: Any) -> bool:
    """Return True if it is a method of one of rclpy's own objects."""
    return type(getattr(callback, "__self__", None)).__module__.partition(".")[0] == "rclpy"


def _name(callback: Any) -> str:
    while isinstance(callback, functools.partial):
        callback = callback.func
    name = getattr(callback, "__name__", type(callback).__name__).replace("<lambda>", "lambda")
    return f"async {name}" if inspect.iscoroutinefunction(callback) else name
