"""A node that does nothing: reports when it is there."""

from __future__ import annotations

import contextlib

import rclpy
from rclpy.executors import ExternalShutdownException

from tests.benchmark.programs.reporting import at_end_of_input, report


def main() -> None:
    rclpy.init()
    node = rclpy.create_node("idle")
    at_end_of_input(rclpy.shutdown)
    report(ready=True)
    with contextlib.suppress(ExternalShutdownException):
        rclpy.spin(node)
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
