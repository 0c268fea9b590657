"""Drives turtle1 by keys: from a notebook with press("up"), or in a terminal as a program.

python -m course_kit.robots.turtlesim.teleop [--ros-args -r __ns:=/robot1 -p scale_linear:=1.0]
"""

from __future__ import annotations

import contextlib
import functools
import sys
from collections import deque
from collections.abc import Callable
from typing import Any

from geometry_msgs.msg import Twist
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.task import Future
from turtlesim.action import RotateAbsolute

from course_kit.base.keyboard import Keyboard
from course_kit.ros.program import program

DRIVING = {"up": (1, 0), "down": (-1, 0), "left": (0, 1), "right": (0, -1)}  # forward, counter-clockwise
# In radians, as the original has them.
HEADINGS = {"g": 0.0, "t": 0.7854, "r": 1.5708, "e": 2.3562, "d": 3.1416, "c": -2.3562, "v": -1.5708, "b": -0.7854}
KEYS = (*DRIVING, *HEADINGS, "f", "q")

USAGE = """\
Drive turtle1 with the keys of this terminal:

  arrow up, down       forward, backward
  arrow left, right    turn left, right
  g t r e d c v b      turn to 0, 45, 90, 135, 180, -135, -90, -45 degrees (where the key lies from f)
  f                    cancel that turn
  q                    quit
"""


class Teleop(Node):
    """The node teleop_turtle, for turtle1 or another one; takes the keyword arguments of rclpy's Node."""

    def __init__(self, turtle: str = "turtle1", name: str = "teleop_turtle", **options: Any) -> None:
        super().__init__(name, **options)
        self.declare_parameter("scale_linear", 2.0)
        self.declare_parameter("scale_angular", 2.0)
        self._cmd_vel = self.create_publisher(Twist, f"{turtle}/cmd_vel", QoSProfile(depth=7))
        self._action = f"{turtle}/rotate_absolute"  # by name, for ROS remaps no actions
        self._rotate: ActionClient | None = ActionClient(self, RotateAbsolute, self._action)
        self._sent: Future | None = None  # the last goal; its result is the goal's handle
        self._tasks: deque[Callable[[], None]] = deque()  # for the executor's thread

    def press(self, key: str) -> bool:
        """Do what a key stands for, one of KEYS, from any thread; False for "q": it is to be the last one.

        Raises ValueError for any other key.
        """
        if key in DRIVING:
            forward, turning = DRIVING[key]
            twist = Twist()
            twist.linear.x = forward * self.get_parameter("scale_linear").value
            twist.angular.z = turning * self.get_parameter("scale_angular").value
            self._cmd_vel.publish(twist)
        elif key in HEADINGS:
            self._in_executor(functools.partial(self._send_goal, HEADINGS[key]))
        elif key == "f":
            self._in_executor(self._cancel_goal)
        elif key != "q":
            raise ValueError(f"teleop_turtle has no key {key!r}; its keys are {', '.join(KEYS)}")
        return key != "q"

    def destroy_node(self) -> None:
        """Take the node and its action client out of the graph."""
        if self._rotate is not None:
            self._rotate.destroy()
            self._rotate = None
        super().destroy_node()

    def _in_executor(self, task: Callable[[], None]) -> None:
        # rclpy's action client loses an answer that another thread takes before the request is noted. And its
        # executor runs the newest of its tasks first, so the order is kept here.
        self._tasks.append(task)
        if self.executor is None:
            self._next_task()
        else:
            self.executor.create_task(self._next_task)

    def _next_task(self) -> None:
        self._tasks.popleft()()

    def _send_goal(self, theta: float) -> None:
        if self._rotate is None:
            return
        if not self._rotate.server_is_ready():
            name = self.resolve_topic_name(self._action)
            self.get_logger().warning(f"No action server {name}: start a turtlesim there, then press again")
            return
        self._sent = self._rotate.send_goal_async(RotateAbsolute.Goal(theta=theta))

    def _cancel_goal(self) -> None:
        if self._sent is not None:
            self._sent.add_done_callback(_cancel)


def _cancel(sent: Future) -> None:
    goal = sent.result()
    if goal is not None and goal.accepted:
        goal.cancel_goal_async()


def main(args: list[str] | None = None) -> None:
    """Read keys from the terminal until q, Ctrl-C or SIGTERM; exit status 0."""
    if not sys.stdin.isatty():
        sys.exit("teleop_turtle reads keys, but its standard input is not a terminal: start it in one")
    with (
        program("teleop_turtle", Teleop, args) as (node, executor, asked),
        Keyboard(sys.stdin.fileno()) as keyboard,
        contextlib.suppress(EOFError),
    ):
        print(USAGE, flush=True)
        while not asked:
            key = keyboard.read(timeout=0.01)
            if key in KEYS and not node.press(key):
                return
            executor.spin_once(timeout_sec=0)


if __name__ == "__main__":
    main()
