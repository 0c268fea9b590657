"""Follows a path by pure pursuit: the robot drives a circle to a point ahead on the path.

An example to read. Seen from the robot, the circle that leads through a point at distance d and bearing b has the
curvature 2 sin(b) / d: that times the speed is how fast to turn. No ROS: the node is Navigator.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from course_kit.robots.navigation.places import Floats, Place, between, wrapped
from course_kit.robots.navigation.planning import length


@dataclass(frozen=True)
class Limits:
    """How a robot may drive; m, m/s, rad/s."""

    speed: float = 0.2
    turning: float = 1.2
    radius: float = 0.105  # of the robot
    ahead: float = 0.25  # how far ahead the point is that it drives at
    stop: float = 0.05  # it comes no nearer to what the laser sees ahead


NEXT = 0.08  # metres ahead on the path to where it turns when something is in the way
SHARP = 0.7  # rad: to a point further aside than this the robot turns first
SLOWEST = 0.04  # m/s, at the end of a path and beside walls
CROWDED = 0.3  # metres to walls beside the robot from which on it is slower
BRAKING = 0.8  # 1/s: speed a metre of room, to what is ahead and to the goal
TURN_GAIN = 2.0  # 1/s


class Pursuit:
    """Follows one path, shape (n, 2), in metres; it remembers how far it is, for a path may cross itself."""

    def __init__(self, path: Floats, limits: Limits) -> None:
        self.path = path
        self.limits = limits
        self._nearest = 0

    def pass_points(self, place: Place) -> None:
        """Leave the points behind that come before the nearest one."""
        # It is looked for a little further on only: the same place may come again later.
        window = self.path[self._nearest : self._nearest + 20]
        self._nearest += int(np.argmin(np.hypot(*(window - np.array(place[:2])).T)))

    def remaining(self, place: Place) -> float:
        """Metres along the path from the robot to its end."""
        return math.dist(place[:2], self.left()[0]) + length(self.left())

    def left(self) -> Floats:
        """The points of the path that are still ahead."""
        return self.path[self._nearest :]

    def target(self, place: Place, ahead: float) -> tuple[float, float]:
        """The point of the path to drive at: the first that is `ahead` metres away or more, else the last."""
        away = np.hypot(*(self.left() - np.array(place[:2])).T)
        far = np.nonzero(away >= ahead)[0]
        x, y = self.left()[far[0] if len(far) else -1]
        return float(x), float(y)

    def command(self, place: Place, room: float, beside: float) -> tuple[float, float]:
        """How to drive, m/s and rad/s; `room`: metres that are free ahead, `beside`: metres to the nearest wall."""
        limits = self.limits
        self.pass_points(place)
        # Straight to a point far ahead it may cut a corner of the path: what stands there is passed by the next points.
        ahead = limits.ahead if room >= limits.stop else NEXT
        x, y, _ = between(place, (*self.target(place, ahead), 0.0))
        distance, bearing = math.hypot(x, y), math.atan2(y, x)
        if abs(bearing) > SHARP or room < limits.stop:
            return 0.0, turn(bearing, limits)
        slower = min(1.0, max(0.0, beside - limits.radius) / CROWDED)
        speed = min(limits.speed * slower, BRAKING * self.remaining(place))
        speed = min(max(speed, SLOWEST), BRAKING * (room - limits.stop) + 0.01)
        turning = speed * 2 * math.sin(bearing) / max(distance, 0.05)
        if abs(turning) > limits.turning:  # the same circle, more slowly
            speed, turning = speed * limits.turning / abs(turning), math.copysign(limits.turning, turning)
        return speed, turning


def turn(angle: float, limits: Limits) -> float:
    """How fast to turn in place, rad/s, to have turned by an angle."""
    wanted = TURN_GAIN * wrapped(angle)
    return math.copysign(min(max(abs(wanted), 0.15), limits.turning), wanted)


def room_ahead(points: Floats, limits: Limits) -> float:
    """Metres that the robot can drive straight ahead until it touches one of the points, seen from it, shape (n, 2)."""
    x, y = points.T
    reach = limits.radius + 0.02
    in_the_way = (np.abs(y) < reach) & (x > 0)
    if not in_the_way.any():
        return math.inf
    return float((x - np.sqrt(np.maximum(limits.radius**2 - y**2, 0.0)))[in_the_way].min())
