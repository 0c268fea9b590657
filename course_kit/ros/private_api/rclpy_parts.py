"""Private parts of rclpy that the course uses.

These are functions that are replaced, the requests that a client waits for, and an executor that rclpy calls
experimental. Actions and serialised messages have modules of their own.
"""

from __future__ import annotations

import functools
import gc
import inspect
import sys
from collections.abc import Callable
from typing import Any

from rclpy.client import Client
from rclpy.context import Context
from rclpy.executors import Executor, MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.node import Node
from rclpy.task import Future

from course_kit.ros.private_api import NotAsExpected, expect, going_on_without

# EventsExecutor's spin() without a timeout runs no callback at all; with one, however long, it works.
EVENTS_TIMEOUT = 3600.0

# Functions of rclpy in whose place the course puts its own.


def replace(owner: Any, name: str, guard_of: Callable[[Any], Callable[..., Any]]) -> None:
    """Put what `guard_of(function)` makes in the place of a function of rclpy's; once is enough.

    NotAsExpected if there is no such function, or if it takes others than the parameters that the guard names.
    """
    expect("rclpy", owner, name)
    plain = getattr(owner, name)
    if hasattr(plain, "is_guard_of_the_course"):
        return
    guard: Any = guard_of(plain)
    parameters = inspect.signature(guard).parameters
    named = [one.name for one in parameters.values() if one.kind not in (one.VAR_POSITIONAL, one.VAR_KEYWORD)]
    theirs = list(inspect.signature(plain).parameters)
    if named != (theirs if len(named) == len(parameters) else theirs[: len(named)]):
        raise NotAsExpected(f"rclpy's {name}() takes other arguments here")
    functools.update_wrapper(guard, plain)
    guard.is_guard_of_the_course = True
    setattr(owner, name, guard)


def choose_default_context(chosen: Callable[[], Context | None]) -> None:
    """Have rclpy take the context that `chosen` gives for the default one; where it gives None, its own.

    For the whole process, once. Each module of rclpy has a name of its own for the function that is asked.
    """

    def guard_of(plain: Callable[..., Context]) -> Callable[..., Context]:
        def get_default_context(*, shutting_down: bool = False) -> Context:
            return chosen() or plain(shutting_down=shutting_down)

        return get_default_context

    for name, module in list(sys.modules.items()):
        if name.partition(".")[0] == "rclpy" and hasattr(module, "get_default_context"):
            replace(module, "get_default_context", guard_of)


# What its loggers, clients and executors keep to themselves.


def nameless_logger() -> RcutilsLogger:
    """A logger without a name, as programs in C have one where there is no node yet."""
    return RcutilsLogger("")


def end_child_loggers(name: str) -> None:
    """Take the child loggers of a node's logger off /rosout, as the node ends.

    rclpy does so when they become garbage, which may be later: to those of a new node of the same name.
    """
    expect("rclpy", RcutilsLogger(), "logger_sublogger_namepair", "__del__")
    for one in gc.get_objects():
        if type(one) is RcutilsLogger and (one.logger_sublogger_namepair or ("",))[0] == name:
            one.__del__()  # which does nothing the second time


def end_state_machine(node: Node) -> None:
    """Take a lifecycle node out of the graph: its state machine would keep it there until both become garbage."""
    machine = getattr(node, "_state_machine", None)
    if machine is not None:
        expect("rclpy", machine, "destroy_when_not_in_use")
        machine.destroy_when_not_in_use()


def pending_requests(client: Client) -> list[Future]:
    """The futures of a client's requests that wait for an answer."""
    expect("rclpy", client, "_pending_requests")
    return list(client._pending_requests.values())


def fast_executor(context: Context) -> Executor:
    """rclpy's EventsExecutor, which is an Executor by its methods alone; the usual one where there is none."""
    with going_on_without("what nodes receive takes three times as long"):
        try:
            from rclpy.experimental import EventsExecutor
        except ImportError:
            raise NotAsExpected("rclpy has no experimental.EventsExecutor here") from None
        return EventsExecutor(context=context)
    return SingleThreadedExecutor(context=context)


def is_fast(executor: Executor) -> bool:
    """Return True if it is an EventsExecutor."""
    return not isinstance(executor, Executor)


def thread_count(executor: Executor) -> int:
    """How many threads of an executor run callbacks."""
    if not isinstance(executor, MultiThreadedExecutor):
        return 1
    pool: Any = getattr(executor, "_executor", None)
    expect("rclpy", pool, "_max_workers")
    return int(pool._max_workers)


def spin_some(executor: Executor, until: Future) -> None:
    """Run callbacks: those of an EventsExecutor until the future is done, else one."""
    if not is_fast(executor):
        executor.spin_once()
        return
    end = Future()  # of this spin only: see below

    def pass_on(_: Future) -> None:
        end.set_result(None)

    until.add_done_callback(pass_on)
    try:
        executor.spin_until_future_complete(end, timeout_sec=EVENTS_TIMEOUT)
    finally:
        until.remove_done_callback(pass_on)
        # An exception leaves a callback of the executor in the future. It is called now, while the executor lives:
        # called later it would lock a mutex that is no more, and with Python 3.14 the process would stand still.
        end.set_result(None)
