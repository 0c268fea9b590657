"""A listener that has just started: `fresh_listener [TIMEOUT]`.

Reports the seconds that it took to make its node, and those until the talker's first message: null if none came.
"""

from __future__ import annotations

import sys
import time

import rclpy
from std_msgs.msg import String

from tests.benchmark.programs.reporting import report

TIMEOUT = 15.0


def main(timeout: float = TIMEOUT) -> None:
    rclpy.init()
    began = time.monotonic()
    node = rclpy.create_node("fresh_listener")
    created = time.monotonic()
    heard: list[float] = []
    node.create_subscription(String, "chatter", lambda message: heard.append(time.monotonic()), 10)
    while not heard and time.monotonic() < created + timeout:
        rclpy.spin_once(node, timeout_sec=0.05)
    report(create=created - began, first=heard[0] - created if heard else None)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main(*map(float, sys.argv[1:]))
