"""The circles in a driven path: where they part, how round and how big they are, whether anything jumped. No ROS."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise
from typing import Any

import numpy as np

from course_kit.robots.turtlesim.paths import Point, Poses
from course_kit.robots.turtlesim.turtle import TICK

STEP = 0.01  # metres between two points that are looked at: whoever turns on the spot stays at one
FEWEST = 8  # points of which a circle can be told
ALIKE = 0.02  # radians between two directions that are taken for the same
STRAYS = 0.05  # the part of a path that may leave its circle, such as a correction at the end


@dataclass(frozen=True)
class Circle:
    """A part of a path, taken for a circle."""

    turned: float = 0.0  # radians around its middle, to the left positive
    length: float = 0.0  # metres
    middle: Point = (0.0, 0.0)
    radius: float = 0.0
    error: float = 0.0  # how far off the circle it comes, as a part of the radius


def two_circles(poses: Poses) -> tuple[Circle, Circle]:
    """The path cut where its direction is farthest from that of its beginning: there it turns the other way."""
    points = _apart(poses)
    turned = [abs(angle) for angle in _turned(points)]
    most = max(turned, default=0.0)
    farthest = [place for place, angle in enumerate(turned) if angle > most - ALIKE]
    cut = farthest[len(farthest) // 2] + 1 if farthest else 0
    return _circle(points[: cut + 1]), _circle(points[cut:])


def turned_in_all(poses: Poses) -> float:
    """Radians that the direction of a path turned, to the left or to the right."""
    return sum(abs(after - before) for before, after in pairwise(_turned(_apart(poses))))


def has_jump(poses: Poses) -> bool:
    """Return True if the turtle came farther somewhere than its velocities allow; three poses may be lost."""
    return any(
        math.dist((a.x, a.y), (b.x, b.y)) > 4 * TICK * max(a.linear_velocity, b.linear_velocity) + 0.005
        for a, b in pairwise(poses)
    )


def _apart(poses: Poses) -> list[Point]:
    points: list[Point] = []
    for pose in poses:
        if not points or math.dist(points[-1], (pose.x, pose.y)) >= STEP:
            points.append((pose.x, pose.y))
    return points


def _turned(points: Sequence[Point]) -> list[float]:
    """At each step how far its direction is from that of the first."""
    directions = [math.atan2(y - b, x - a) for (a, b), (x, y) in pairwise(points)]
    changes = (math.remainder(after - before, math.tau) for before, after in pairwise(directions))
    return list(accumulate(changes, initial=0.0)) if directions else []


def _circle(points: Sequence[Point]) -> Circle:
    """The circle of least squares."""
    if len(points) < FEWEST:
        return Circle()
    at: Any = np.asarray(points)
    (x, y, rest), *_ = np.linalg.lstsq(np.c_[2 * at, np.ones(len(at))], (at**2).sum(axis=1), rcond=None)
    radius = math.sqrt(max(rest + x * x + y * y, 0.0)) or math.inf
    angles = np.unwrap(np.arctan2(at[:, 1] - y, at[:, 0] - x))
    errors = abs(np.hypot(at[:, 0] - x, at[:, 1] - y) / radius - 1)
    return Circle(
        turned=float(angles[-1] - angles[0]),
        length=float(np.hypot(*np.diff(at, axis=0).T).sum()),
        middle=(float(x), float(y)),
        radius=radius,
        error=float(np.quantile(errors, 1 - STRAYS)),
    )
