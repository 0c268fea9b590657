"""Places in the plane, x and y in metres and a heading in radians, and steps from one to the next. No ROS.

A place is also a transform: that of a frame that lies there, as tf2 has it.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Place = tuple[float, float, float]  # x, y in m, heading in rad, counter-clockwise from the x axis


def wrapped(angle: float) -> float:
    """The same angle from -π to π."""
    return math.remainder(angle, math.tau)


def after(place: Place, step: Place) -> Place:
    """Where a step leads that is seen from a place: 1 m ahead of (2, 0, π/2) is (2, 1, π/2)."""
    x, y, heading = place
    cosine, sine = math.cos(heading), math.sin(heading)
    return x + cosine * step[0] - sine * step[1], y + sine * step[0] + cosine * step[1], wrapped(heading + step[2])


def between(start: Place, end: Place) -> Place:
    """The step that leads from one place to another: after(start, between(start, end)) is the end."""
    x, y = end[0] - start[0], end[1] - start[1]
    cosine, sine = math.cos(start[2]), math.sin(start[2])
    return cosine * x + sine * y, cosine * y - sine * x, wrapped(end[2] - start[2])


def inverse(place: Place) -> Place:
    """The way back: where the origin is, seen from a place."""
    return between(place, (0.0, 0.0, 0.0))


def moved(points: Floats, place: Place) -> Floats:
    """Points that are seen from a place, shape (n, 2), as points of the frame in which that place is given."""
    cosine, sine = math.cos(place[2]), math.sin(place[2])
    return points @ np.array([[cosine, sine], [-sine, cosine]]) + np.array(place[:2])


def hits(angles: Floats, ranges: Floats) -> Floats:
    """The points that a scan has hit, seen from the laser, shape (n, 2); what is not finite has hit nothing."""
    hit = np.isfinite(ranges)
    return np.column_stack([ranges[hit] * np.cos(angles[hit]), ranges[hit] * np.sin(angles[hit])])
