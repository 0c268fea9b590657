"""Spins nodes of a kind until the end of the input, and reports once they see the whole graph."""

from __future__ import annotations

import contextlib
from collections.abc import Callable

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node

from tests.benchmark.programs.reporting import at_end_of_input, report


def spin(make: Callable[[int, int], Node], process: int, nodes: int, total: int) -> None:
    """Spin so many nodes, `make(process, index)` each; report `ready` once the first one sees `total` nodes."""
    rclpy.init()
    executor = SingleThreadedExecutor()
    made = [make(process, index) for index in range(nodes)]
    for node in made:
        executor.add_node(node)

    def count() -> None:
        if len(made[0].get_node_names()) >= total:
            counting.cancel()
            report(ready=True)

    counting = made[0].create_timer(0.2, count)
    at_end_of_input(rclpy.shutdown)
    with contextlib.suppress(ExternalShutdownException):
        executor.spin()
    rclpy.try_shutdown()
