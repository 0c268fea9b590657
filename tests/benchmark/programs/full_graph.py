"""Nodes with a topic, a service and an action each, to be listed: `full_graph PROCESS NODES TOTAL`.

Node N of process P is /robot_P_N with the topic /robot_P_N/state, the service …/reset and the action …/count. Reports
once it sees all TOTAL nodes.
"""

from __future__ import annotations

import sys
from typing import Any

from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Trigger

from tests.benchmark.programs import ready_nodes


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


if __name__ == "__main__":
    ready_nodes.spin(FullNode, *map(int, sys.argv[1:]))
