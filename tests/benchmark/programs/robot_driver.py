"""Drives the robot in a circle, and hears all its topics."""

from __future__ import annotations

import time

import rclpy
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import qos_profile_sensor_data
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, JointState, LaserScan
from tf2_msgs.msg import TFMessage

from tests.benchmark.programs.reporting import at_end_of_input, report

FIRST_TIMEOUT = 20.0
TOPICS = {
    "odom": Odometry,
    "imu": Imu,
    "joint_states": JointState,
    "scan": LaserScan,
    "/tf": TFMessage,
    "/clock": Clock,
}


def main() -> None:
    rclpy.init()
    node = rclpy.create_node("driver")
    heard: set[str] = set()
    for topic, kind in TOPICS.items():

        def hear(_: object, topic: str = topic) -> None:
            heard.add(topic)

        node.create_subscription(kind, topic, hear, qos_profile_sensor_data)
    sender = node.create_publisher(TwistStamped, "cmd_vel", 10)
    command = TwistStamped()
    command.twist.linear.x, command.twist.angular.z = 0.1, 0.5
    node.create_timer(0.02, lambda: sender.publish(command))
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    deadline = time.monotonic() + FIRST_TIMEOUT
    while heard < TOPICS.keys():
        if time.monotonic() > deadline:
            raise SystemExit(f"nothing on {', '.join(TOPICS.keys() - heard)} within {FIRST_TIMEOUT:g} s")
        executor.spin_once(timeout_sec=0.1)
    report(ready=True)
    at_end_of_input(executor.shutdown)
    executor.spin()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
