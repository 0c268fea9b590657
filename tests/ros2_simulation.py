"""A simulation slower than the clock on the wall, for the tests of `ros2`; and names of several kinds. A program.

`/ticks` and `/stamped` come 25 times a simulated second, which is 20 times a second on the wall or, on a busy machine,
less often. `/kept` comes once a second on the wall. A message on `/reset` sets the simulation back to 0, where it stays
for a while.
"""

from __future__ import annotations

import contextlib
import time
from typing import Any

import rclpy
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PointStamped
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Empty, Int32, String

STEP, STEPS_A_SECOND = 4_000_000, 200  # nanoseconds of the simulation in a step; steps a second on the wall
EVERY = 10  # steps from one message to the next
START = 1000 * 10**9
DELAY = 250_000_000  # nanoseconds, simulated, that a message of /stamped is old
STANDS = 100  # steps after a reset
OLD, FIRST = 100, 50  # the first messages of /kept: how many seconds they are old, and how many they are


def stamp(nanoseconds: int) -> Time:
    return Time(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)


class Simulation(Node):
    def __init__(self) -> None:
        super().__init__("simulation")
        self.now, self.steps, self.stands = START, 0, 0
        self.clock = self.create_publisher(Clock, "clock", 10)
        self.ticks = self.create_publisher(Int32, "ticks", 10)
        self.stamped = self.create_publisher(PointStamped, "stamped", 10)
        self.secret = self.create_publisher(String, "_secret", 10)
        kept = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.kept = self.create_publisher(PointStamped, "kept", kept)
        for _ in range(FIRST):
            self.publish_kept(OLD)
        self.create_subscription(Empty, "reset", self.reset, 10)
        self.create_timer(1 / STEPS_A_SECOND, self.step)
        self.create_timer(1.0, self.publish_kept)

    def step(self) -> None:
        if self.stands:
            self.stands -= 1
        else:
            self.now += STEP
        self.clock.publish(Clock(clock=stamp(self.now)))
        self.steps += 1
        if self.steps % EVERY == 0:
            self.ticks.publish(Int32(data=self.steps // EVERY))
            message = PointStamped()
            message.header.stamp = stamp(max(0, self.now - DELAY))
            self.stamped.publish(message)

    def publish_kept(self, age: int = 0) -> None:
        message = PointStamped()
        message.header.stamp = stamp(time.time_ns() - age * 10**9)
        self.kept.publish(message)

    def reset(self, message: Any) -> None:
        self.now, self.stands = 0, STANDS


def main() -> None:
    rclpy.init()
    executor = SingleThreadedExecutor()
    nodes = [Simulation(), *map(Node, ("_backstage", "twin", "twin"))]
    for node in nodes:
        executor.add_node(node)
    print("ready", flush=True)
    with contextlib.suppress(KeyboardInterrupt):
        executor.spin()


if __name__ == "__main__":
    main()
