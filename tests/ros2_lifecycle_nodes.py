"""Lifecycle nodes for the tests of `ros2 lifecycle`, and a plain one beside them. A program."""

from __future__ import annotations

import os
import signal
import sys
import threading

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode, State, TransitionCallbackReturn
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions


class Stubborn(LifecycleNode):
    """Refuses to be configured."""

    def on_configure(self, state: State) -> TransitionCallbackReturn:
        return TransitionCallbackReturn.FAILURE


class Mortal(LifecycleNode):
    """Ends its process when it is configured, unannounced."""

    def on_configure(self, state: State) -> TransitionCallbackReturn:
        os._exit(0)


def main(*names: str) -> None:
    """Spin nodes of these names, but none that is called /asleep; `stubborn`, `mortal`, `plain` are what they say."""
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    signal.signal(signal.SIGINT, lambda *_: os._exit(0))
    classes = {"stubborn": Stubborn, "mortal": Mortal, "plain": Node}
    nodes = [classes.get(name, LifecycleNode)(name) for name in names]
    executor = SingleThreadedExecutor()
    for node in nodes:
        if node.get_name() != "asleep":
            executor.add_node(node)
    threading.Thread(target=executor.spin, daemon=True).start()
    print("ready", flush=True)
    signal.pause()


if __name__ == "__main__":
    main(*sys.argv[1:])
