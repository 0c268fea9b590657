"""Rotations as tf2's tools print and read them: quaternion, matrix, roll, pitch and yaw. Pure, no ROS.

Roll, pitch and yaw are turns about the fixed axes x, y, z, one after another, in radians (REP 103).
"""

from __future__ import annotations

import math

Quaternion = tuple[float, float, float, float]  # x, y, z, w
Matrix = tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]


def quaternion(roll: float, pitch: float, yaw: float) -> Quaternion:
    """The quaternion of a turn by roll, pitch and yaw."""
    (sr, cr), (sp, cp), (sy, cy) = ((math.sin(angle / 2), math.cos(angle / 2)) for angle in (roll, pitch, yaw))
    return (
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )


def matrix(turn: Quaternion) -> Matrix:
    """The rotation matrix of a quaternion, which need not have the length 1; one of zeros is no turn."""
    x, y, z, w = turn
    scale = 2.0 / (x * x + y * y + z * z + w * w or 2.0)
    xs, ys, zs = x * scale, y * scale, z * scale
    return (
        (1 - (y * ys + z * zs), x * ys - w * zs, x * zs + w * ys),
        (x * ys + w * zs, 1 - (x * xs + z * zs), y * zs - w * xs),
        (x * zs - w * ys, y * zs + w * xs, 1 - (x * xs + y * ys)),
    )


def roll_pitch_yaw(turn: Matrix) -> tuple[float, float, float]:
    """Roll, pitch and yaw of a rotation matrix; where the x axis looks straight up or down, yaw is 0."""
    down = turn[2][0]
    if abs(down) >= 1:
        return math.atan2(turn[2][1], turn[2][2]), math.copysign(math.pi / 2, -down), 0.0
    pitch = -math.asin(down)
    along = math.cos(pitch)
    roll = math.atan2(turn[2][1] / along, turn[2][2] / along)
    return roll, pitch, math.atan2(turn[1][0] / along, turn[0][0] / along)
