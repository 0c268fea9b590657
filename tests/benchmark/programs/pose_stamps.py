"""When turtle1 published its poses, by the middleware's own stamps: `watch SECONDS` reports them in nanoseconds."""

from __future__ import annotations

import sys
import time
from typing import Any

import rclpy
from rclpy.qos import QoSProfile
from turtlesim.msg import Pose

from tests.benchmark.programs.reporting import report

FIRST_TIMEOUT = 20.0


def main() -> None:
    rclpy.init()
    node = rclpy.create_node("pose_stamps")
    stamps: list[int] = []

    def hear(pose: Any, info: dict[str, int]) -> None:
        stamps.append(info["source_timestamp"])

    # rclpy's annotation forgets that a callback may take the message's information too.
    node.create_subscription(Pose, "/turtle1/pose", hear, QoSProfile(depth=100))  # type: ignore[arg-type]
    deadline = time.monotonic() + FIRST_TIMEOUT
    while not stamps:
        if time.monotonic() > deadline:
            raise SystemExit(f"no pose of turtle1 within {FIRST_TIMEOUT:g} s")
        rclpy.spin_once(node, timeout_sec=0.1)
    report(ready=True)
    for line in sys.stdin:
        end = time.monotonic() + float(line.split()[1])
        stamps.clear()
        while time.monotonic() < end:
            rclpy.spin_once(node, timeout_sec=0.1)
        report(stamps=stamps)
    rclpy.shutdown()


if __name__ == "__main__":
    main()
