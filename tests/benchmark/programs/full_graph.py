"""Nodes with a topic, a service and an action each, to be listed: `full_graph PROCESS NODES TOTAL`.

Node N of process P is /robot_P_N with the topic /robot_P_N/state, the service …/reset and the action …/count. Reports
once it sees all TOTAL nodes.
"""

from __future__ import annotations

import contextlib
import sys
from typing import Any

import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Trigger

from tests.benchmark.programs.reporting import at_end_of_input, report


class FullNode(Node):
    def __init__(self, process: int, index: int) -> None:
        super().__init__(f"robot_{process}_{index}")
        publisher = self.create_publisher(String, "~/state", 10)
        self.create_timer(0.5, lambda: publisher.publish(String(data="idle")))
        self.create_service(Trigger, "~/reset", lambda request, response: response)
        self.server = ActionServer(self, Fibonacci, "~/count", self.count)

    def count(self, goal: Any) -> Any:
        goal.succeed()
        return Fibonacci.Result()


def main(process: int, nodes: int, total: int) -> None:
    rclpy.init()
    executor = SingleThreadedExecutor()
    made = [FullNode(process, index) for index in range(nodes)]
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


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
