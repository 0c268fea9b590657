"""Plain rclpy nodes that run already when a fresh one comes: `warm_nodes PROCESS NODES TOTAL`.

Each node publishes to a topic of its own at 10 Hz and listens to one of the next process; the first node of process
0 is the talker, 100 Hz on /chatter. Reports once it sees all TOTAL nodes.
"""

from __future__ import annotations

import sys

from rclpy.node import Node
from std_msgs.msg import String

from tests.benchmark.programs import ready_nodes

PROCESSES = 5


class WarmNode(Node):
    def __init__(self, process: int, index: int) -> None:
        super().__init__(f"warm_{process}_{index}")
        is_talker = (process, index) == (0, 0)
        publisher = self.create_publisher(String, "chatter" if is_talker else f"out_{process}_{index}", 10)
        message = String(data="hello")
        self.create_timer(0.01 if is_talker else 0.1, lambda: publisher.publish(message))
        neighbour = (process + 1) % PROCESSES
        self.create_subscription(String, f"out_{neighbour}_{index}", lambda message: None, 10)


if __name__ == "__main__":
    ready_nodes.spin(WarmNode, *map(int, sys.argv[1:]))
