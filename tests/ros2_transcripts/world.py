"""The world that the transcripts were recorded in: five nodes, spun in one process."""

from __future__ import annotations

import contextlib
import time
from typing import Any

import rclpy
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import IntegerRange, ParameterDescriptor
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger

BEAMS = ParameterDescriptor(
    description="Number of beams", integer_range=[IntegerRange(from_value=1, to_value=360, step=1)]
)


class Talker(Node):
    def __init__(self) -> None:
        super().__init__("talker")
        self.publisher = self.create_publisher(String, "chatter", 10)
        self.count = 0
        self.create_timer(0.1, self.talk)

    def talk(self) -> None:
        self.publisher.publish(String(data=f"Hello ROS2: {self.count}"))
        self.count += 1


class Listener(Node):
    def __init__(self) -> None:
        super().__init__("listener")
        self.create_subscription(String, "chatter", lambda message: None, 10)


class Lidar(Node):
    def __init__(self) -> None:
        super().__init__("lidar", namespace="/robot1")
        self.declare_parameter("rate_hz", 10.0)
        self.declare_parameter("frame_id", "laser")
        self.declare_parameter("beams", 5, BEAMS)
        self.declare_parameter("enabled", True)
        self.declare_parameter("angles", [0.0, 0.5, 1.0])
        self.publisher = self.create_publisher(LaserScan, "scan", qos_profile_sensor_data)
        self.create_timer(0.1, self.scan)
        self.create_subscription(Twist, "cmd_vel", lambda message: None, 10)
        self.create_service(SetBool, "enable", self.enable)
        self.create_service(Trigger, "self_test", self.test)

    def enable(self, request: Any, response: Any) -> Any:
        response.success = True
        response.message = "enabled" if request.data else "disabled"
        return response

    def test(self, request: Any, response: Any) -> Any:
        response.success = True
        response.message = "all beams fine"
        return response

    def scan(self) -> None:
        scan = LaserScan(angle_min=-1.0, angle_max=1.0, angle_increment=0.5, range_min=0.1, range_max=10.0)
        scan.header.frame_id = "laser"
        scan.ranges = [1.0, 2.0, 3.0, 4.0, 5.0]
        self.publisher.publish(scan)


class Adder(Node):
    def __init__(self) -> None:
        super().__init__("add_two_ints_server")
        self.create_service(AddTwoInts, "add_two_ints", self.add)

    def add(self, request: Any, response: Any) -> Any:
        response.sum = request.a + request.b
        return response


class FibonacciServer(Node):
    def __init__(self) -> None:
        super().__init__("fibonacci_action_server")
        self.server = ActionServer(
            self,
            Fibonacci,
            "fibonacci",
            self.execute,
            cancel_callback=lambda goal: CancelResponse.ACCEPT,
            callback_group=ReentrantCallbackGroup(),
        )

    def execute(self, goal: Any) -> Any:
        if goal.request.order < 0:
            goal.abort()
            return Fibonacci.Result()
        sequence = [0, 1]
        for n in range(1, goal.request.order):
            if goal.is_cancel_requested:
                goal.canceled()
                return Fibonacci.Result(sequence=sequence)
            sequence.append(sequence[n] + sequence[n - 1])
            goal.publish_feedback(Fibonacci.Feedback(sequence=sequence))
            time.sleep(0.05)
        goal.succeed()
        return Fibonacci.Result(sequence=sequence)


def main() -> None:
    rclpy.init()
    executor = MultiThreadedExecutor(4)
    for node in (Talker(), Listener(), Lidar(), Adder(), FibonacciServer()):
        executor.add_node(node)
    print("ready", flush=True)
    with contextlib.suppress(KeyboardInterrupt):
        executor.spin()


if __name__ == "__main__":
    main()
