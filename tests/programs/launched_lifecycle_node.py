"""A lifecycle node that refuses to be configured if its parameter `fails` is set; it spins until it is interrupted."""

from __future__ import annotations

import contextlib

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn


class Launched(LifecycleNode):
    """Tells its transitions."""

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Fail if the parameter says so."""
        print("configuring", flush=True)
        fails = self.declare_parameter("fails", False).value
        return TransitionCallbackReturn.FAILURE if fails else TransitionCallbackReturn.SUCCESS

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Become active."""
        print("active", flush=True)
        return TransitionCallbackReturn.SUCCESS


def main() -> None:
    """Run it."""
    rclpy.init()
    node = Launched("launched")
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(node)
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
