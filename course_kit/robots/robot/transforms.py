"""The robot's frames on /tf and /tf_static, as tf2's broadcasters and robot_state_publisher tell them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Quaternion, TransformStamped
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from tf2_msgs.msg import TFMessage

from course_kit.robots.robot import shape

if TYPE_CHECKING:
    from course_kit.robots.robot.world import Place

# As tf2_ros has them: many transforms in a row, and for each publisher all that stands still.
DYNAMIC = QoSProfile(depth=100)
STATIC = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Transforms:
    """odom → base_link and base_link → wheels on /tf; what is bolted on, once, on /tf_static."""

    def __init__(self, node: Node, prefix: str, stamp: Time) -> None:
        self._moving = node.create_publisher(TFMessage, "/tf", DYNAMIC)
        self._fixed = node.create_publisher(TFMessage, "/tf_static", STATIC)
        base = f"{prefix}base_link"
        self._odom = _transform(f"{prefix}odom", base, (0.0, 0.0, shape.BASE_HEIGHT))
        side, up = shape.WHEEL_SEPARATION / 2, shape.WHEEL_HEIGHT
        self._wheels = [
            _transform(base, f"{prefix}wheel_{name}_link", (0.0, y, up))
            for name, y in (("left", side), ("right", -side))
        ]
        self._message = TFMessage(transforms=[self._odom, *self._wheels])
        fixed = {
            "base_footprint": (0.0, 0.0, -shape.BASE_HEIGHT),
            "base_scan": shape.LASER,
            "imu_link": shape.IMU,
        }
        transforms = [_transform(base, prefix + name, place) for name, place in fixed.items()]
        for one in transforms:
            one.header.stamp = stamp
        self._fixed.publish(TFMessage(transforms=transforms))

    def hear_corrections(self, node: Node, on_correction: Callable[[Time], None]) -> None:
        """Call this with each stamp for which somebody tells where odom lies, as in the frame map."""
        odom = self._odom.header.frame_id

        def on_message(message: TFMessage) -> None:
            for one in message.transforms:
                if one.child_frame_id == odom:
                    on_correction(one.header.stamp)

        node.create_subscription(TFMessage, "/tf", on_message, DYNAMIC)

    def publish(self, stamp: Time, place: Place, angles: Sequence[float]) -> None:
        """Tell where the wheels' odometry has base_link in odom, and how far the wheels have turned (rad)."""
        for one in self._message.transforms:
            one.header.stamp = stamp
        translation = self._odom.transform.translation
        translation.x, translation.y = place[0], place[1]
        turn(self._odom.transform.rotation, place[2])
        for one, angle in zip(self._wheels, angles, strict=True):
            rotation, half = one.transform.rotation, float(angle) / 2
            rotation.y, rotation.w = math.sin(half), math.cos(half)
        self._moving.publish(self._message)


def turn(rotation: Quaternion, heading: float) -> None:
    """Make a quaternion the turn by `heading` (rad) about z."""
    rotation.z, rotation.w = math.sin(heading / 2), math.cos(heading / 2)


def _transform(parent: str, child: str, place: Sequence[float]) -> TransformStamped:
    one = TransformStamped(child_frame_id=child)
    one.header.frame_id = parent
    translation = one.transform.translation
    translation.x, translation.y, translation.z = (float(part) for part in place)
    return one
