"""Messages of geometry_msgs, and rclpy's times, as the rest of this package has them."""

from __future__ import annotations

from typing import Any

import numpy as np
from builtin_interfaces.msg import Time as TimeMessage
from geometry_msgs.msg import Quaternion, Transform, TransformStamped, Vector3
from rclpy.time import Time

from course_kit.robots.tf.link_history import Sample
from course_kit.robots.tf.rigid_transforms import Floats, RigidTransform

SECOND = 10**9  # ns


def nanoseconds(value: Any, what: str = "time") -> int:
    """A time or duration of rclpy, or a message of one, in ns. TypeError for what is neither."""
    if hasattr(value, "sec") and hasattr(value, "nanosec"):
        return int(value.sec) * SECOND + int(value.nanosec)
    if hasattr(value, "nanoseconds"):
        return int(value.nanoseconds)
    latest = "rclpy.time.Time() for the latest transform, or the stamp of a message"
    instead = latest if what == "time" else "rclpy.duration.Duration(seconds=1.0)"
    raise TypeError(f"{what} must have sec and nanosec, or nanoseconds. {value!r} has not: write {instead}")


def time_message(stamp: int) -> TimeMessage:
    """A moment in ns as a message."""
    return TimeMessage(sec=stamp // SECOND, nanosec=stamp % SECOND)


def time_of(stamp: int) -> Time:
    """A moment in ns as rclpy has it."""
    return Time(nanoseconds=stamp)


def vector(message: Any) -> Floats:
    """x, y and z of a Point or Vector3, shape (3,)."""
    return np.array([message.x, message.y, message.z], np.float64)


def quaternion(message: Any) -> Floats:
    """w, x, y and z of a Quaternion, shape (4,)."""
    return np.array([message.w, message.x, message.y, message.z], np.float64)


def placement(transform: Transform) -> RigidTransform:
    """Where a Transform puts a frame."""
    return RigidTransform(vector(transform.translation), quaternion(transform.rotation))


def sample(message: TransformStamped) -> tuple[str, Sample]:
    """The frame that a TransformStamped is about, and where it was; a slash before a name is dropped, as tf2 does."""
    parent = message.header.frame_id.removeprefix("/")
    moment = nanoseconds(message.header.stamp)
    return message.child_frame_id.removeprefix("/"), Sample(moment, parent, placement(message.transform))


def put(target: Any, values: Floats) -> None:
    """Write x, y and z of a Point or Vector3."""
    target.x, target.y, target.z = map(float, values)


def quaternion_message(values: Floats) -> Quaternion:
    """A Quaternion from w, x, y and z."""
    w, x, y, z = map(float, values)
    return Quaternion(x=x, y=y, z=z, w=w)


def transform_stamped(target: str, source: str, stamp: int, where: RigidTransform) -> TransformStamped:
    """Where the source frame is in the target frame, as a message."""
    message = TransformStamped(child_frame_id=source)
    message.header.frame_id = target
    message.header.stamp = time_message(stamp)
    x, y, z = map(float, where.translation)
    message.transform.translation = Vector3(x=x, y=y, z=z)
    message.transform.rotation = quaternion_message(where.rotation)
    return message
