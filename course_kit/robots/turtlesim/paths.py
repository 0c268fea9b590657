"""The shape of a driven path: closed or not, how far it turned left and right, which points it visited. No ROS."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from itertools import accumulate, pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

STAR_STEP = math.radians(2)  # from one direction that is tried to the next
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


def turned(poses: Poses) -> float:
    """Degrees that the turtle turned in all, to whichever side."""
    return math.degrees(sum(abs(after - before) for before, after in pairwise(headings(poses))))


def longest_jump(poses: Poses) -> float:
    """The longest way between two poses that follow each other, metres."""
    return max((math.dist((a.x, a.y), (b.x, b.y)) for a, b in pairwise(poses)), default=0.0)


def top_speed(poses: Poses) -> float:
    """The greatest `linear_velocity` of a path, m/s."""
    return max((pose.linear_velocity for pose in poses), default=0.0)


def carried(poses: Poses) -> float:
    """Metres that the turtle moved without a velocity: by teleports."""
    return sum(math.dist((a.x, a.y), (b.x, b.y)) for a, b in pairwise(poses) if b.linear_velocity == 0.0)


def star_missed_by(poses: Poses, corner: Point, side: float) -> float:
    """How far the path stays from the points of a star that are to be reached one after another, at most; metres.

    The star begins and ends at `corner` and has lines of `side` metres: the one of them all that fits best.
    """
    path = np.array([(pose.x, pose.y) for pose in poses])
    missed = math.inf
    for first, way in itertools.product(np.arange(0.0, math.tau, STAR_STEP), (1, -1)):
        headings = first + way * 2 * math.tau / 5 * np.arange(5)
        points = np.array(corner) + side * np.cumsum(np.column_stack([np.cos(headings), np.sin(headings)]), axis=0)
        # For each pose how far the worst of the points is that were reached before.
        so_far: npt.NDArray[np.float64] = np.zeros(len(path))
        for point in points:
            so_far = np.minimum.accumulate(np.maximum(so_far, np.hypot(*(path - point).T)))
        missed = min(missed, float(so_far[-1]))
    return missed


def nearest_approach(poses: Poses, point: Point) -> float:
    """How near the path came to a point, metres."""
    return min((math.dist((pose.x, pose.y), point) for pose in poses), default=math.inf)


def star(middle: Point, radius: float) -> list[Point]:
    """The corners of a five-pointed star in the order of one stroke, the first straight above the middle, closed."""
    angles = [math.pi / 2 + 2 * number * math.tau / 5 for number in range(6)]
    return [(middle[0] + radius * math.cos(a), middle[1] + radius * math.sin(a)) for a in angles]
