"""Tracks of a robot: place, heading and speed, from messages that carry a pose. Pure numpy."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

import numpy as np
import numpy.typing as npt

from course_kit.lab.recordings.rate_statistics import Float64s


@dataclass(frozen=True)
class Track:
    """A robot's motion in the plane; all arrays have the shape (messages,)."""

    times: Float64s  # seconds
    x: Float64s  # m
    y: Float64s  # m
    heading: Float64s  # rad, -pi to pi
    linear: Float64s  # m/s, forwards
    angular: Float64s  # rad/s, to the left

    @property
    def jumps(self) -> npt.NDArray[np.bool_]:
        """True if the robot was put somewhere else after a message, faster than it drives: shape (messages - 1,)."""
        way = np.hypot(np.diff(self.x), np.diff(self.y))
        fastest = np.maximum(np.abs(self.linear[1:]), np.abs(self.linear[:-1]))
        return np.asarray(way > 0.1 + 3.0 * fastest * np.diff(self.times))


def track(messages: Iterable[Any], type_name: str, times: Float64s, stamps: Float64s | None = None) -> Track:
    """The track of messages that came at `times` (seconds); velocities are differentiated where there are none.

    Stamps (seconds), where there are any, are the times at which the poses were true and are used to differentiate.
    Raises ValueError for a type without a pose.
    """
    if type_name not in READERS:
        raise ValueError(f"{type_name} carries no pose: there is a track in {', '.join(READERS)}")
    rows = np.array([READERS[type_name](message) for message in messages], np.float64)
    columns = rows.reshape(len(rows), -1).T
    if len(columns) == 5:  # it says its velocities
        x, y, heading, linear, angular = columns
    else:
        x, y, heading = columns
        clock = times if stamps is None or np.any(np.diff(stamps) <= 0) else stamps
        linear, angular = _differentiate(clock, x, y, heading)
    return Track(times, x, y, np.arctan2(np.sin(heading), np.cos(heading)), linear, angular)


def _differentiate(clock: Float64s, x: Float64s, y: Float64s, heading: Float64s) -> tuple[Float64s, Float64s]:
    """Forward and turning speed from how position and heading change."""
    if len(clock) < 2 or np.any(np.diff(clock) <= 0):
        return np.full(len(clock), np.nan), np.full(len(clock), np.nan)
    velocity_x, velocity_y = np.gradient(x, clock), np.gradient(y, clock)
    linear = velocity_x * np.cos(heading) + velocity_y * np.sin(heading)
    return linear, np.gradient(np.unwrap(heading), clock)


def _pose(pose: Any) -> tuple[float, ...]:
    return pose.position.x, pose.position.y, yaw(pose.orientation)


def _odometry(message: Any) -> tuple[float, ...]:
    twist = message.twist.twist
    return *_pose(message.pose.pose), twist.linear.x, twist.angular.z


def yaw(q: Any) -> float:
    """The heading of a quaternion with x, y, z, w: the turn about the vertical axis, rad."""
    return float(np.arctan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z)))


READERS: dict[str, Callable[[Any], tuple[float, ...]]] = {
    "turtlesim/msg/Pose": attrgetter("x", "y", "theta", "linear_velocity", "angular_velocity"),
    "geometry_msgs/msg/PoseStamped": lambda message: _pose(message.pose),
    "nav_msgs/msg/Odometry": _odometry,
}
