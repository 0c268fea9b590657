"""The ROS face of one turtle: its topics, services and action, relative to the node's namespace."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from geometry_msgs.msg import Twist
from rclpy.qos import QoSProfile
from turtlesim.msg import Color, Pose
from turtlesim.srv import SetPen, TeleportAbsolute, TeleportRelative

from course_kit.robots.turtlesim.rotate_server import RotateServer
from course_kit.robots.turtlesim.turtle import Reading

if TYPE_CHECKING:
    from course_kit.robots.turtlesim.node import TurtleSim

QOS = QoSProfile(depth=7)  # keep last, reliable, volatile
LINGER = 63  # ticks (1 s) that a killed turtle's action stays: clients still ask how their goals ended


class TurtleInterface:
    """What of a turtle is in the ROS graph. Raises what rclpy raises for a name that cannot be there."""

    def __init__(self, node: TurtleSim, name: str) -> None:
        self._node = node
        self._name = name
        self._lingers = 0  # ticks left for a killed turtle
        self._topics_and_services = contextlib.ExitStack()  # which ends them
        self.rotate = RotateServer(node, f"{name}/rotate_absolute", lambda goal: node.world.rotate(name, goal))
        try:
            self._create_topics_and_services()
        except Exception:
            self.destroy()
            raise

    # Its life.

    def retire(self) -> None:
        """Take a killed turtle out of the graph; its action goes later, and rejects goals until then."""
        self._topics_and_services.close()
        self.rotate.retired = True
        self._lingers = LINGER if self.rotate.used else 0

    def revive(self) -> None:
        """Bring a turtle back that was killed a moment ago."""
        self._create_topics_and_services()
        self.rotate.retired = False

    def linger(self) -> bool:
        """Count a tick of a killed turtle; False when its time is over."""
        self._lingers -= 1
        return self._lingers > 0

    def destroy(self) -> None:
        """Take all of it out of the graph at once."""
        self._topics_and_services.close()
        self.rotate.destroy()

    def publish(self, reading: Reading) -> None:
        """Publish what a tick has told about the turtle."""
        if reading.remaining is not None:
            self.rotate.publish_feedback(reading.remaining)
        self._pose.publish(Pose(**reading.pose._asdict()))
        red, green, blue = reading.color
        self._color.publish(Color(r=red, g=green, b=blue))

    # Its entities and their callbacks.

    def _create_topics_and_services(self) -> None:
        node, name, world, at_end = self._node, self._name, self._node.world, self._topics_and_services.callback
        self._pose = node.create_publisher(Pose, f"{name}/pose", QOS)
        at_end(node.destroy_publisher, self._pose)
        self._color = node.create_publisher(Color, f"{name}/color_sensor", QOS)
        at_end(node.destroy_publisher, self._color)
        at_end(node.destroy_subscription, node.create_subscription(Twist, f"{name}/cmd_vel", self._on_cmd_vel, QOS))
        changes: dict[str, tuple[Any, Callable[[Any], None]]] = {
            "set_pen": (SetPen, lambda r: world.set_pen(name, (r.r, r.g, r.b), r.width, off=bool(r.off))),
            "teleport_absolute": (TeleportAbsolute, lambda r: world.teleport_absolute(name, r.x, r.y, r.theta)),
            "teleport_relative": (TeleportRelative, lambda r: world.teleport_relative(name, r.linear, r.angular)),
        }
        for service, (kind, change) in changes.items():
            at_end(node.destroy_service, node.create_service(kind, f"{name}/{service}", node.serving(change)))

    def _on_cmd_vel(self, twist: Twist) -> None:
        sideways = twist.linear.y if self._node.get_parameter("holonomic").value else 0.0
        self._node.world.command(self._name, twist.linear.x, sideways, twist.angular.z, time.monotonic_ns())
        self._node.settle()
