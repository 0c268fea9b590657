"""Services and actions that behave badly, and publishers of several QoS, for the tests of `ros2`. A program."""

from __future__ import annotations

import os
import signal
import sys
import threading
from typing import Any

import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import ByteMultiArray, String
from std_srvs.srv import Trigger

from course_kit.base.shutdown.watchdog import END_TIMEOUT


class Servers(Node):
    """`/silent` never answers, `/mortal` kills its process instead; of the actions see the names."""

    def __init__(self, namespace: str) -> None:
        super().__init__("servers", namespace=namespace)
        self.ended = threading.Event()
        group = ReentrantCallbackGroup()
        self.create_service(Trigger, "silent", self._be_silent, callback_group=group)
        self.create_service(Trigger, "mortal", self._die, callback_group=group)
        work = {"mortal_action": self._die, "slow": self._end_late}
        for name, takes_goals, can_cancel in (
            ("refusing", False, True),
            ("endless", True, True),
            ("stubborn", True, False),
            ("slow", True, True),
            ("mortal_action", True, True),
        ):
            ActionServer(
                self,
                Fibonacci,
                name,
                work.get(name, self._go_on),
                goal_callback=lambda goal, takes=takes_goals: GoalResponse.ACCEPT if takes else GoalResponse.REJECT,
                cancel_callback=lambda goal, can=can_cancel: CancelResponse.ACCEPT if can else CancelResponse.REJECT,
                callback_group=group,
            )
        latched = QoSProfile(depth=3, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.latched = self.create_publisher(String, "latched", latched)
        for text in ("one", "two", "three"):
            self.latched.publish(String(data=text))
        mixed = (ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT)
        self.mixed = [self.create_publisher(String, "mixed", QoSProfile(depth=5, reliability=r)) for r in mixed]
        self.octets = self.create_publisher(ByteMultiArray, "octets", 5)
        self.create_timer(0.05, self._publish, callback_group=group)

    def _publish(self) -> None:
        for number, publisher in enumerate(self.mixed):
            publisher.publish(String(data=f"from publisher {number}"))
        self.octets.publish(ByteMultiArray(data=[b"\x00", b"a", b"\xff"]))

    def _be_silent(self, request: Any, response: Any) -> Any:
        self.ended.wait()
        return response

    def _die(self, *_: Any) -> Any:
        """End at once, unannounced: the graph knows when the participant's lease is over."""
        os._exit(0)

    def _go_on(self, goal: Any) -> Any:
        while not goal.is_cancel_requested and not self.ended.wait(0.01):
            pass
        if goal.is_cancel_requested:
            goal.canceled()
        return Fibonacci.Result(sequence=[7])

    def _end_late(self, goal: Any) -> Any:
        """Cancel when `ros2` would have been ended, were it one that does not heed its interrupt."""
        while not goal.is_cancel_requested and not self.ended.wait(0.01):
            pass
        self.ended.wait(END_TIMEOUT + 0.5)
        return self._go_on(goal)


def main() -> None:
    # rclpy's own handler ends spin() twice, with ExternalShutdownException and with KeyboardInterrupt, in either order;
    # what comes second would wait for the callbacks that never return.
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    signal.signal(signal.SIGINT, lambda *_: os._exit(0))
    node = Servers("".join(sys.argv[1:]))
    executor = MultiThreadedExecutor(8)
    executor.add_node(node)
    print("ready", flush=True)
    executor.spin()


if __name__ == "__main__":
    main()
