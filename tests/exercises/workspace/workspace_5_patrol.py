"""Answers to workspace-5: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, solved, worked

PATROL_PY = "\n" + solved("workspace-5").files["ros2_ws/src/patrol/patrol/patrol.py"]
# By time, to the right, in a timer; what may change is kept by a callback.
BY_TIME = """
import math
import sys

import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import SetParametersResult
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node

TURN, TICK = 1.2, 0.02


class Patrol(Node):
    def __init__(self):
        Node.__init__(self, "patrol")
        self.values = {}
        self.add_on_set_parameters_callback(self.check)
        self.declare_parameters("", [("side", 1.5), ("speed", 1.0)])
        self.pub = self.create_publisher(Twist, "turtle1/cmd_vel", 1)
        self.state, self.until = "turn", self.get_clock().now()
        self.twist = Twist()
        self.create_timer(TICK, self.step)

    def check(self, parameters):
        for parameter in parameters:
            if parameter.name == "speed" and not parameter.value > 0:
                return SetParametersResult(successful=False, reason="speed must be above 0")
        self.values.update({parameter.name: parameter.value for parameter in parameters})
        return SetParametersResult(successful=True)

    def step(self):
        now = self.get_clock().now()
        if self.pub.get_subscription_count() == 0:
            self.until = now
            return
        if now >= self.until:
            self.state = "turn" if self.state == "drive" else "drive"
            self.twist = Twist()
            if self.state == "drive":
                self.twist.linear.x = self.values["speed"]
                seconds = self.values["side"] / self.values["speed"]
            else:
                self.twist.angular.z = -TURN
                seconds = math.pi / 2 / TURN
            self.until = self.until + rclpy.duration.Duration(seconds=seconds)
        self.pub.publish(self.twist)


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(Patrol())
    except (KeyboardInterrupt, ExternalShutdownException):
        sys.exit(0)
"""
# Its squares lie aslant; a generator says what is done next, in a loop of its own.
ASLANT = """
import math

import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import SetParametersResult
from turtlesim.msg import Pose


def refuse(parameters):
    slow = [one for one in parameters if one.name == "speed" and one.value <= 0]
    return SetParametersResult(successful=not slow, reason="too slow" if slow else "")


def main():
    rclpy.init()
    node = rclpy.create_node("patrol")
    node.declare_parameter("side", 1.0)
    node.declare_parameter("speed", 1.0)
    node.add_on_set_parameters_callback(refuse)
    out = node.create_publisher(Twist, "turtle1/cmd_vel", 10)
    poses = []
    node.create_subscription(Pose, "turtle1/pose", poses.append, 10)

    def turned(angle):
        begin = poses[-1].theta
        while abs(math.remainder(poses[-1].theta - begin - angle, math.tau)) > 0.03:
            twist = Twist()
            twist.angular.z = max(0.3, min(1.0, 3 * (angle - math.remainder(poses[-1].theta - begin, math.tau))))
            yield twist

    def plan():
        yield from turned(0.6)
        while True:
            side, speed, begin = (*(one.value for one in node.get_parameters(["side", "speed"])), poses[-1])
            while math.hypot(poses[-1].x - begin.x, poses[-1].y - begin.y) < side:
                twist = Twist()
                twist.linear.x = speed
                yield twist
            yield from turned(math.pi / 2)

    steps = plan()
    try:
        while rclpy.ok():
            rclpy.spin_once(node)
            if poses:
                out.publish(next(steps))
                del poses[:-1]
    except KeyboardInterrupt:
        pass
"""
PATROL_LAUNCH = "\n" + solved("workspace-5").files["ros2_ws/src/patrol/launch/patrol.launch.py"]
GROUPED_LAUNCH = """
from pathlib import Path

from launch import LaunchDescription
from launch.actions import GroupAction
from launch_ros.actions import Node, PushROSNamespace


def generate_launch_description():
    config = Path(__file__).parents[1] / "config"
    return LaunchDescription([
        GroupAction([
            PushROSNamespace(file.stem),
            Node(package="turtlesim", executable="turtlesim_node", parameters=[str(file)]),
            Node(package="patrol", executable="patrol", parameters=[file]),
        ])
        for file in sorted(config.glob("*.yaml"))
    ])
"""
YAML = "/**:\n  ros__parameters:\n    side: {side}\n    speed: {speed}\n"
# Of both nodes, the patrol's after another; what is for one node stands over what is for all.
BOTH_NODES = """
/{room}:
  turtlesim:
    ros__parameters:
      background_r: 200
  patrol:
    ros__parameters:
      side: {side}
/**/patrol:
  ros__parameters:
    speed: {speed}
"""


def patrol(code: str = PATROL_PY, launch: str = PATROL_LAUNCH, head: str = "/**:", yaml: str = YAML) -> str:
    """The cell that makes and builds the package."""
    files = {
        "patrol/patrol.py": code,
        "launch/patrol.launch.py": launch,
        "config/one.yaml": yaml.format(room="one", side=1.0, speed=1.5).replace("/**:", head),
        "config/two.yaml": yaml.format(room="two", side=3.0, speed=1.0).replace("/**:", head),
    }
    return f"""
fresh("patrol", "--build-type", "ament_python", programs=["patrol"], files={files!r})
build("patrol")
"""


READ_ONCE = changed(
    PATROL_PY,
    ('self.declare_parameter("side", 2.0)', 'self.side = self.declare_parameter("side", 2.0).value'),
    ('self.get_parameter("side").value', "self.side"),
)
KEEPS_REFUSED = changed(
    PATROL_PY,
    ('self.declare_parameter("speed", 1.0)', 'self.speed = self.declare_parameter("speed", 1.0).value'),
    (
        "        if any(one.name",
        '        for one in parameters:\n            self.speed = one.value if one.name == "speed" else self.speed\n'
        "        if any(one.name",
    ),
    ('self.get_parameter("speed").value', "self.speed"),
)

ANSWERS = Answers(
    "workspace-5",
    5,
    f"leave_out('patrol')\n{worked('workspace-5')}",
    [
        Wrong(
            "triangle",
            patrol(changed(PATROL_PY, ("self.heading + math.pi / 2", "self.heading + math.tau / 3"))),
            3,
            "then a turn by 90°",
        ),
        Wrong(
            "read_once_and_no_small_speed",
            patrol(changed(READ_ONCE, ("one.value <= 0.0", "one.value < 0.5"))),
            3,
            "not in __init__",
        ),
        Wrong(
            "absolute_and_any_speed",
            patrol(
                changed(
                    PATROL_PY,
                    ('"turtle1/cmd_vel"', '"/turtle1/cmd_vel"'),
                    ('"turtle1/pose"', '"/turtle1/pose"'),
                    ("one.value <= 0.0", "False"),
                )
            ),
            3,
            "0 was taken",
        ),
        Wrong("file_for_another", patrol(head="patrol:"), 4, "its first line names"),
        Wrong(
            "slow_turns_and_one_file",
            patrol(
                changed(PATROL_PY, ("max(-2.0, min(2.0, 4.0 * error))", "max(-0.5, min(0.5, 4.0 * error))")),
                changed(PATROL_LAUNCH, ('name + ".yaml"', '"one.yaml"')),
            ),
            3,
            "it turned at 0.50 rad/s",
        ),
        Wrong(
            "raises",
            patrol(
                changed(
                    PATROL_PY,
                    (
                        'return SetParametersResult(successful=False, reason="it would never arrive")',
                        'raise ValueError("it would never arrive")',
                    ),
                )
            ),
            4,
            "was not answered",
        ),
        Wrong(
            "returns_nothing",
            patrol(
                changed(
                    PATROL_PY,
                    ('return SetParametersResult(successful=False, reason="it would never arrive")', "return"),
                )
            ),
            4,
            "refused without a reason",
        ),
        Wrong("keeps_refused", patrol(KEEPS_REFUSED), 4, "keeps nothing of what it refuses"),
    ],
    {"by_time": patrol(BY_TIME, GROUPED_LAUNCH), "aslant": patrol(ASLANT, yaml=BOTH_NODES)},
    together=4,
)
