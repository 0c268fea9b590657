"""Measures of a driven path that shall be a square: its sides, its corners, how fast it turns. No ROS."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from itertools import groupby
from typing import Any

from course_kit.robots.turtlesim import paths

Poses = Sequence[Any]  # turtlesim/msg/Pose
LAP = 1.15 * math.tau  # radians that the turtle turns on a lap, and more than it may overshoot
STANDS = 0.05  # m/s and rad/s below which it does not drive, or does not turn
TURN = 1.0  # radians of a turn that is looked at: those at the ends of a lap may be cut


def is_square(poses: Poses, side: float) -> bool:
    """A square of this side is as wide and as high, however it lies, and its way is four sides or more.

    Four times the heading is the same on all its sides; on those of a triangle it is not.
    """
    fourfold = [cmath.exp(4j * pose.theta) for pose in poses if pose.linear_velocity > STANDS]
    is_right = bool(fourfold) and abs(sum(fourfold)) / len(fourfold) > 0.7
    near = 0.15 * side + 0.15
    way = paths.length(poses)
    return is_right and all(abs(metres - side) < near for metres in extent(poses)) and 3.4 * side < way < 5.8 * side


def extent(poses: Poses) -> tuple[float, float]:
    """Metres from side to side, along the sides and across."""
    fourfold = sum(cmath.exp(4j * pose.theta) for pose in poses if pose.linear_velocity > STANDS)
    back = cmath.exp(-1j * cmath.phase(fourfold) / 4) if fourfold else 1.0
    places = [complex(pose.x, pose.y) * back for pose in poses]
    if not places:
        return 0.0, 0.0
    xs, ys = [place.real for place in places], [place.imag for place in places]
    return max(xs) - min(xs), max(ys) - min(ys)


def turns(poses: Poses) -> list[float]:
    """The greatest rate of each turn, rad/s."""
    found = []
    for turning, part in groupby(poses, lambda pose: abs(pose.angular_velocity) > STANDS):
        turn = list(part)
        if turning and abs(paths.headings(turn)[-1]) > TURN:
            found.append(max(abs(pose.angular_velocity) for pose in turn))
    return found


def described(poses: Poses) -> str:
    """What was seen of a lap."""
    width, height = extent(poses)
    rates = turns(poses)
    turned = f"it turned at {min(rates):.2f} rad/s" if rates else "it made no turn"
    speed = paths.top_speed(poses)
    return (
        f"the path is {width:.1f} m by {height:.1f} m, {paths.length(poses):.1f} m long, at {speed:.2f} m/s, {turned}"
    )
