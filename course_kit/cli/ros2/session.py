"""The session of a verb: its output, its node, the graph, and when it has to end."""

from __future__ import annotations

import contextlib
import math
import signal
import sys
import time
from argparse import Namespace
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, Any

from course_kit.base.kernel import in_kernel
from course_kit.base.polling import wait_until
from course_kit.base.shutdown.signals import put_off
from course_kit.ros.private_api.import_parts import arrays_later

if TYPE_CHECKING:
    from rclpy.node import Node

POLL = 0.01  # seconds between two looks at a condition


class DurationOver(Exception):  # noqa: N818 - it is no error
    """The time that --duration gives to a verb is over: it ends well."""


def log_text(level: str, logger: str, text: str, stamp: int) -> str:
    """A line as rcl's console shows it; `stamp` in nanoseconds since the epoch."""
    seconds, nanoseconds = divmod(stamp, 10**9)
    return f"[{level}] [{seconds}.{nanoseconds:09}] [{logger}]: {text}"


@contextlib.contextmanager
def handling(number: signal.Signals, handler: Any) -> Iterator[None]:
    """Have a signal handled by `handler`, or ignored, while the block runs."""
    before = signal.signal(number, handler)
    try:
        yield
    finally:
        signal.signal(number, before)


class Session:
    """One run of one verb, in the main thread of a process of its own or of a notebook's kernel.

    Both have one ROS context and the node of the instruments, spun in a thread of its own: callbacks put what comes
    into a queue, and the verb takes it out here. So an interrupt reaches the verb and never ends ROS.
    """

    def __init__(self, args: Namespace) -> None:
        self.in_notebook = in_kernel()
        self._args = args
        duration: float | None = getattr(args, "duration", None)
        self._deadline = math.inf if duration is None else time.monotonic() + duration

    def print(self, text: str = "", end: str = "\n") -> None:
        """Write to stdout, at once and as one piece: an interrupt falls between lines."""
        sys.stdout.write(text + end)
        sys.stdout.flush()

    def warn(self, text: str) -> None:
        """Write a line to stderr, at once."""
        print(text, file=sys.stderr, flush=True)

    def warn_of(self, lines: SimpleQueue[str]) -> None:
        """Write the lines that callbacks have left to stderr."""
        while not lines.empty():
            self.warn(lines.get())

    def join(self) -> None:
        """Join the graph: others tell of themselves while the rest is imported. Only to be quicker."""
        if not self.in_notebook:
            from course_kit.ros.spinning import presence

            with put_off():
                presence.begin()
            with arrays_later():  # of a service, which each node has
                pass

    @property
    def node(self) -> Node:
        """The node of this process that watches and calls; its name is hidden. Do not wait in its callbacks."""
        from course_kit.ros.subscriptions import observer_node

        if not self.in_notebook:
            observer_node.appear_as("_ros2cli", with_rosout=True)
        with put_off():
            return observer_node.node()

    @contextlib.contextmanager
    def own_node(self, name: str, **settings: bool) -> Iterator[Node]:
        """A node of the verb's own while the block runs; action clients may be made on it, see executor_for()."""
        from rclpy.executors import SingleThreadedExecutor

        from course_kit.ros.spinning import errors
        from course_kit.ros.spinning.executors import SpinThread
        from course_kit.ros.spinning.nodes import quiet_node

        node = quiet_node(name, self.node.context, **settings)
        executor = SingleThreadedExecutor(context=node.context)
        with contextlib.closing(SpinThread(node, partial(errors.report, name), executor).start()):
            yield node

    def graph(self) -> Node:
        """The node, once it knows the whole graph as it is now."""
        from course_kit.ros.graph import discovery

        node = self.node
        spin_time: float | None = getattr(self._args, "spin_time", None)
        known = discovery.of(node, keep=self.in_notebook)
        say_late = None if self.in_notebook else self.warn  # a saved output must not depend on how busy a machine is
        known.wait(discovery.WHOLE_TIMEOUT if spin_time is None else spin_time, say_late)
        return node

    def named(self, noun: str, with_hidden: bool = False) -> Mapping[str, Sequence[str]]:
        """The topics, services or actions by their noun, with types; hidden ones too if that, or the option, says so.

        No action is hidden.
        """
        from course_kit.ros.graph import graph

        node = self.graph()
        with_hidden = with_hidden or getattr(self._args, f"include_hidden_{noun}s", False)
        return graph.actions(node) if noun == "action" else getattr(graph, f"{noun}s")(node, with_hidden)

    def check_time(self) -> None:
        """Raise DurationOver if --duration has passed."""
        if time.monotonic() >= self._deadline:
            raise DurationOver

    def until(self, condition: Callable[[], Any], timeout: float | None = None, poll: float = POLL) -> bool:
        """Wait until a condition is true; False if it is not within `timeout` seconds (None: wait on)."""

        def holds() -> bool:
            if not (value := condition()):
                self.check_time()
            return bool(value)

        return wait_until(holds, timeout, poll)

    def sleep(self, seconds: float) -> None:
        """Pause, but not beyond --duration."""
        self.until(lambda: False, timeout=seconds)

    def items(self, queue: SimpleQueue[Any], timeout: float | None = None) -> Iterator[Any]:
        """What callbacks put into a queue, as it comes; ends when nothing has come for `timeout` seconds."""
        waited = time.monotonic()
        while True:
            self.check_time()
            try:
                item = queue.get(timeout=0.05)
            except Empty:
                if timeout is not None and time.monotonic() - waited >= timeout:
                    return
                continue
            yield item
            waited = time.monotonic()
