"""The main function of a node's program: ROS starts before the node, and ends after it at a signal."""

from __future__ import annotations

import contextlib
import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any, TypeVar

import rclpy
from rclpy.exceptions import ParameterException
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args

from course_kit.base.shutdown import watchdog
from course_kit.base.shutdown.signals import asking_to_end, leave_closed_terminal

SIGNAL_TIMEOUT = 0.1  # seconds until a signal is looked at where no message comes
NodeType = TypeVar("NodeType", bound=Node)


def spin(name: str, node_class: Callable[[], Node], args: list[str] | None) -> None:
    """Run one node until Ctrl-C or SIGTERM; exit status 0."""
    with program(name, node_class, args) as (_, executor, asked):
        while not asked:
            executor.spin_once(timeout_sec=1)


def spin_for(executor: SingleThreadedExecutor, asked: list[int], seconds: float) -> None:
    """Run callbacks for some seconds, or until a signal has asked for the end."""
    deadline = time.monotonic() + seconds
    while not asked and (left := deadline - time.monotonic()) > 0:
        executor.spin_once(timeout_sec=min(left, SIGNAL_TIMEOUT))


def own_words(name: str, args: list[str] | None) -> list[str]:
    """What a command line (or args) has besides ROS's own arguments, without the program's name.

    Arguments that ROS does not take end the program with one line and exit status 1.
    """
    try:
        return list(remove_ros_args(sys.argv if args is None else args)[1:])
    except RuntimeError as error:
        sys.exit(f"{name} cannot start: {error}")


@contextmanager
def program(
    name: str, node_class: Callable[[], NodeType], args: list[str] | None
) -> Iterator[tuple[NodeType, SingleThreadedExecutor, list[int]]]:
    """Start ROS with the command line (or args) and make the node; both end after the block.

    The block gets the node, its executor, and the signals that have asked for its end so far: Ctrl-C and SIGTERM ask
    for it, a second Ctrl-C ends the block at once. Arguments that ROS does not take end the program with one line and
    exit status 1.
    """
    # rclpy's own handlers end the context from another thread: in the middle of a node's constructor that is
    # an error, and so it is in the middle of try_shutdown().
    asked: list[int] = []
    made: list[Node] = []
    status = 1
    before: dict[int, Any] = {}

    def on_signal(number: int, _: FrameType | None) -> None:
        leave_closed_terminal()
        asked.append(number)
        for each in before:
            signal.signal(each, signal.default_int_handler)

    before.update((each, signal.signal(each, on_signal)) for each in (signal.SIGINT, *asking_to_end()))
    watchdog.end_after_signals()
    try:
        try:
            rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
        except RuntimeError as error:
            sys.exit(f"{name} cannot start: {error}")
        node = node_class()
        made.append(node)
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        try:
            yield node, executor, asked
        finally:  # left to become garbage with its guard condition, it may destroy that a second time and say so
            executor.shutdown(timeout_sec=0)
        status = 0
    except (KeyboardInterrupt, ExternalShutdownException):
        status = 0
    except ParameterException as error:
        sys.exit(f"{name} cannot start: {error}")
    finally:
        _leave_ros(made, status)
        watchdog.heed_no_signals()
        for number, handler in before.items():
            signal.signal(number, handler)


def _leave_ros(nodes: list[Node], status: int) -> None:
    sys.stdout.flush()
    watchdog.end_in(watchdog.END_TIMEOUT, status)
    with contextlib.suppress(KeyboardInterrupt):
        for node in nodes:
            node.destroy_node()
    rclpy.try_shutdown()
