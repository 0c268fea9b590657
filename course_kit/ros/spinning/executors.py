"""One executor in a thread of its own, as one process on a robot has one executor for its node."""

from __future__ import annotations

import contextlib
import contextvars
import ctypes
import inspect
import threading
from collections.abc import Callable
from typing import Any

from rclpy.executors import Executor, ExternalShutdownException, ShutdownException, SingleThreadedExecutor
from rclpy.logging import LoggingSeverity
from rclpy.node import Node
from rclpy.task import Future

from course_kit.ros.private_api.rclpy_parts import fast_executor, is_fast, spin_some
from course_kit.ros.spinning import BlockingWait, NodeStopped, stalls
from course_kit.ros.spinning.nodes import actions_of, destroy


def executor_for(node: Node) -> Executor:
    """The executor that suits a node: one thread, and the callback groups of rclpy where they matter.

    rclpy's EventsExecutor has a third of the SingleThreadedExecutor's latency and keeps its speed beside other
    threads, but does not look at callback groups. In one thread they matter to `async def` callbacks alone, so a
    node that has one gets the SingleThreadedExecutor, and waits here where it would wait on a robot. So does one with
    an action client or server: in rclpy 7.1.6 the EventsExecutor crashes when an action client gets an answer that
    was not for it. And so does one with a callback that takes message info, at which it fails.
    """
    if needs_usual_executor(node):
        return SingleThreadedExecutor(context=node.context)
    return fast_executor(node.context)


def needs_usual_executor(node: Node) -> bool:
    """Return True if a node has something that the EventsExecutor does not do as the others."""
    if actions_of(node):
        return True
    entities: list[Any] = [*node.subscriptions, *node.timers, *node.services]
    return any(inspect.iscoroutinefunction(entity.callback) for entity in entities) or _takes_info(node)


def _takes_info(node: Node) -> bool:
    """Return True if a subscription has a callback that takes the message and its info, found out as rclpy does."""
    for subscription in node.subscriptions:
        try:
            inspect.signature(subscription.callback).bind(object())
        except TypeError:
            return True
    return False


class SpinThread:
    """Spins a node until stop(); an exception in a callback goes to `on_error` and the spinning goes on."""

    def __init__(self, node: Node, on_error: Callable[[Exception], None], executor: Executor | None = None) -> None:
        self.node = node
        self.executor = executor or executor_for(node)
        self.on_error = on_error
        self._stopping = Future()
        # A copy of the cell's context: what a callback prints appears under the cell that started the node.
        target, name = contextvars.copy_context().run, node.get_fully_qualified_name()
        self._thread = threading.Thread(target=target, args=(self._spin,), name=name, daemon=True)
        self._stall: stalls.Stall | None = None

    def start(self) -> SpinThread:
        """Begin; returns itself."""
        self.executor.add_node(self.node)
        _threads[self._thread] = self
        self._thread.start()
        return self

    def close(self, timeout: float = 1.0) -> None:
        """stop(), then destroy the node: one that is destroyed while it is waited on raises InvalidHandle.

        A log level that was set for the node ends with it.
        """
        self.stop(timeout)
        with contextlib.suppress(Exception):  # a student may have destroyed it, or the whole context
            self.executor.remove_node(self.node)
        destroy(self.node)
        with contextlib.suppress(Exception):  # the process keeps levels by name; a program started anew has none
            self.node.get_logger().set_level(LoggingSeverity.UNSET)
        with contextlib.suppress(Exception):
            self.executor.shutdown(timeout_sec=0.5)

    def stall(self) -> stalls.Stall | None:
        """The callback that runs now and ran at the last look already, since then; None if none does."""
        self._stall = stalls.look(self._thread, self._stall) if self.is_alive else None
        return self._stall

    @property
    def is_alive(self) -> bool:
        """True if the thread runs."""
        return self._thread.is_alive()

    def _spin(self) -> None:
        while not self._stopping.done() and self.executor.context.ok():
            try:
                spin_some(self.executor, self._stopping)
            except (ExternalShutdownException, ShutdownException, NodeStopped):
                return
            except Exception as error:
                if self._stopping.done():
                    return
                if isinstance(error, SystemError) and is_fast(self.executor) and _takes_info(self.node):
                    self._change_executor()  # it was made for a node without such a subscription
                else:
                    self.on_error(error)

    def _change_executor(self) -> None:
        before, self.executor = self.executor, executor_for(self.node)
        before.remove_node(self.node)
        before.shutdown(timeout_sec=0.5)
        self.executor.add_node(self.node)

    def stop(self, timeout: float = 1.0) -> None:
        """End the thread. A callback that does not return within `timeout` seconds has NodeStopped raised inside it."""
        self._stopping.set_result(None)
        with contextlib.suppress(Exception):  # the context may be gone
            self.executor.create_task(lambda: None)  # wake() alone does not end spin_once()
        if self._thread is not threading.current_thread() and self._thread.is_alive():
            self._thread.join(timeout)
            if self._thread.is_alive():
                interrupt(self._thread)
                self._thread.join(0.5)
        if not self._thread.is_alive():
            _threads.pop(self._thread, None)


def interrupt(thread: threading.Thread) -> None:
    """Raise NodeStopped in a thread that runs: ends Python loops at once and a sleep when it is over."""
    if thread.is_alive() and thread.ident is not None:
        ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread.ident), ctypes.py_object(NodeStopped))


_threads: dict[threading.Thread, SpinThread] = {}


def current() -> SpinThread | None:
    """The SpinThread whose callback is running now, or None outside of callbacks."""
    return _threads.get(threading.current_thread())


def spinning_now() -> list[SpinThread]:
    """Those that run."""
    return [spinning for spinning in list(_threads.values()) if spinning.is_alive]


def executor_of(node: Node) -> Executor | None:
    """The executor that spins a node in a SpinThread, or None."""
    for spinning in spinning_now():
        if node in spinning.executor.get_nodes():
            return spinning.executor
    return None


def report(node: Node, error: Exception) -> None:
    """Tell whoever runs a node in a SpinThread of an error that rclpy keeps to itself."""
    for spinning in spinning_now():
        if spinning.node is node:
            spinning.on_error(error)


def refuse_in_callback(what: str) -> None:
    """Raise BlockingWait if a callback of a background node is running in this thread."""
    if current() is not None:
        raise BlockingWait(
            f"{what} inside a callback would wait for ever: the answer can only be delivered by the executor that is "
            f"busy running this callback. Make the callback `async def` and await the future of call_async(), "
            f"or add a done callback to it."
        )
