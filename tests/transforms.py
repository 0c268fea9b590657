"""Transforms for tests: plane ones, and what is read from one."""

from __future__ import annotations

import math

from geometry_msgs.msg import TransformStamped
from rclpy.time import Time


def at(child: str, parent: str, seconds: float, x: float = 0.0, y: float = 0.0, yaw: float = 0.0) -> TransformStamped:
    """Where a frame is in its parent at a time in seconds: m, m, radians."""
    message = TransformStamped(child_frame_id=child)
    message.header.frame_id = parent
    message.header.stamp = Time(nanoseconds=round(seconds * 1e9)).to_msg()
    message.transform.translation.x, message.transform.translation.y = x, y
    message.transform.rotation.z, message.transform.rotation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    return message


def place(message: TransformStamped) -> tuple[float, float, float]:
    """x, y and yaw of a plane transform."""
    shift, turn = message.transform.translation, message.transform.rotation
    return shift.x, shift.y, 2 * math.atan2(turn.z, turn.w)


def stamp(message: TransformStamped) -> float:
    """Its time in seconds."""
    return Time.from_msg(message.header.stamp).nanoseconds * 1e-9
