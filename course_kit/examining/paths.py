"""The shape of a driven path: closed or not, how far it turned left and right, which points it visited. No ROS."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise
from typing import Any

Point = tuple[float, float]
Poses = Sequence[Any]  # turtlesim/msg/Pose, or what has its x and y (metres) and theta (radians)


def gap(poses: Poses) -> float:
    """Metres from the end to the beginning."""
    return math.dist((poses[0].x, poses[0].y), (poses[-1].x, poses[-1].y))


def length(poses: Poses) -> float:
    """Metres along the path."""
    return sum(math.dist((a.x, a.y), (b.x, b.y)) for a, b in pairwise(poses))


def headings(poses: Poses) -> list[float]:
    """The heading at each pose, counted on beyond half turns, from 0 at the first."""
    turns = (math.remainder(b.theta - a.theta, math.tau) for a, b in pairwise(poses))
    return list(accumulate(turns, initial=0.0))


@dataclass(frozen=True)
class Loop:
    """A part of a path that turns one way: radians, to the left positive, and metres."""

    turned: float
    length: float


def two_loops(poses: Poses) -> tuple[Loop, Loop]:
    """The path cut where the heading is farthest from where it began."""
    turned = headings(poses)
    cut = max(range(len(turned)), key=lambda place: abs(turned[place]))
    first = Loop(turned[cut], length(poses[: cut + 1]))
    second = Loop(turned[-1] - turned[cut], length(poses[cut:]))
    return first, second


def longest_jump(poses: Poses) -> float:
    """The longest way between two poses that follow each other, metres."""
    return max((math.dist((a.x, a.y), (b.x, b.y)) for a, b in pairwise(poses)), default=0.0)


def top_speed(poses: Poses) -> float:
    """The greatest `linear_velocity` of a path, m/s."""
    return max((pose.linear_velocity for pose in poses), default=0.0)


def nearest_approach(poses: Poses, point: Point) -> float:
    """How near the path came to a point, metres."""
    return min((math.dist((pose.x, pose.y), point) for pose in poses), default=math.inf)


def star(middle: Point, radius: float) -> list[Point]:
    """The corners of a five-pointed star in the order of one stroke, the first straight above the middle, closed."""
    angles = [math.pi / 2 + 2 * number * math.tau / 5 for number in range(6)]
    return [(middle[0] + radius * math.cos(a), middle[1] + radius * math.sin(a)) for a in angles]
