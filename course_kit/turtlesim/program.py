"""What surrounds a node that runs as a program: ROS starts before it, and ends after it at a signal."""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

import rclpy
from rclpy.exceptions import ParameterException
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

SIGNALS = (signal.SIGINT, signal.SIGTERM)


def spin(name: str, node_class: Callable[[], Node], args: list[str] | None) -> None:
    """Run one node until Ctrl-C or SIGTERM; exit status 0."""
    with program(name, args) as is_to_end:
        node = node_class()
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        while not is_to_end():
            executor.spin_once(timeout_sec=1)
        node.destroy_node()


@contextmanager
def program(name: str, args: list[str] | None) -> Iterator[Callable[[], bool]]:
    """Start ROS with the command line (or args); gives a function that says whether the program is to end.

    Ctrl-C and SIGTERM ask for that; a second Ctrl-C ends it at once. Arguments that ROS does not take end the
    program with one line and exit status 1.
    """
    # rclpy's own handlers end the context from another thread: in the middle of a node's constructor that is
    # an error, and so it is in the middle of try_shutdown().
    asked: list[int] = []
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
        yield lambda: bool(asked)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except ParameterException as error:
        sys.exit(f"{name} cannot start: {error}")
    finally:
        rclpy.try_shutdown()
        for number, handler in before.items():
            signal.signal(number, handler)
