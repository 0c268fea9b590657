"""mimic: a turtle does what another one does. Topics are remapped to say which:

ros2 run turtlesim mimic --ros-args -r input/pose:=/a/turtle1/pose -r output/cmd_vel:=/b/turtle1/cmd_vel
"""

from __future__ import annotations

from typing import Any

from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import QoSProfile
from turtlesim.msg import Pose

from course_kit.ros.program import spin


class Mimic(Node):
    """The node turtle_mimic: publishes as a command the velocity of each pose that comes."""

    def __init__(self, **options: Any) -> None:
        super().__init__("turtle_mimic", **options)
        self._command = self.create_publisher(Twist, "output/cmd_vel", QoSProfile(depth=7))
        self.create_subscription(Pose, "input/pose", self._follow, QoSProfile(depth=7))

    def _follow(self, pose: Pose) -> None:
        twist = Twist()
        twist.linear.x = pose.linear_velocity
        twist.angular.z = pose.angular_velocity
        self._command.publish(twist)


def main(args: list[str] | None = None) -> None:
    """Follow until Ctrl-C or SIGTERM; exit status 0."""
    spin("turtle_mimic", Mimic, args)


if __name__ == "__main__":
    main()
