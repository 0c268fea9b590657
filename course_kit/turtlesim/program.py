"""What surrounds a node that runs as a program: ROS starts before it, and ends after it at a signal."""

from __future__ import annotations

import contextlib
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType
from typing import Generic, TypeVar

import rclpy
from rclpy.exceptions import ParameterException
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from course_kit.ending.exit_timer import ExitTimer

SIGNALS = (signal.SIGINT, signal.SIGTERM)
END_TIMEOUT = 3.0  # seconds for leaving ROS; a launch waits 5 before its next signal
NodeType = TypeVar("NodeType", bound=Node)


@dataclass(frozen=True)
class Program(Generic[NodeType]):
    """A program that runs: its node, the node's executor, and whether a signal has asked for its end."""

    node: NodeType
    executor: SingleThreadedExecutor
    is_to_end: Callable[[], bool]


def spin(name: str, node_class: Callable[[], Node], args: list[str] | None) -> None:
    """Run one node until Ctrl-C or SIGTERM; exit status 0."""
    with program(name, node_class, args) as running:
        while not running.is_to_end():
            running.executor.spin_once(timeout_sec=1)


@contextmanager
def program(name: str, node_class: Callable[[], NodeType], args: list[str] | None) -> Iterator[Program[NodeType]]:
    """Start ROS with the command line (or args) and make the node; both end after the block.

    Ctrl-C and SIGTERM ask for the end; a second Ctrl-C ends the block at once. Arguments that ROS does not take end the
    program with one line and exit status 1.
    """
    # rclpy's own handlers end the context from another thread: in the middle of a node's constructor that is
    # an error, and so it is in the middle of try_shutdown().
    asked: list[int] = []
    made: list[Node] = []
    status = 1
    before = {number: signal.getsignal(number) for number in SIGNALS}

    def on_signal(number: int, _: FrameType | None) -> None:
        asked.append(number)
        for each in SIGNALS:
            signal.signal(each, signal.default_int_handler)

    for number in SIGNALS:
        signal.signal(number, on_signal)
    try:
        try:
            rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
        except RuntimeError as error:
            sys.exit(f"{name} cannot start: {error}")
        node = node_class()
        made.append(node)
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        yield Program(node, executor, lambda: bool(asked))
        status = 0
    except (KeyboardInterrupt, ExternalShutdownException):
        status = 0
    except ParameterException as error:
        sys.exit(f"{name} cannot start: {error}")
    finally:
        _leave_ros(made, status)
        for number, handler in before.items():
            signal.signal(number, handler)


def _leave_ros(nodes: list[Node], status: int) -> None:
    sys.stdout.flush()
    timer = ExitTimer(END_TIMEOUT, status)
    with contextlib.suppress(KeyboardInterrupt):
        for node in nodes:
            node.destroy_node()
    rclpy.try_shutdown()
    timer.cancel()
