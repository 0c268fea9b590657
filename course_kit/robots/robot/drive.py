"""From a wanted velocity to the wheels, and from the wheels to where the robot takes itself to be. No ROS."""

from __future__ import annotations

import math
from collections.abc import Sequence

from course_kit.robots.robot.shape import MAX_ANGULAR, MAX_LINEAR, MAX_WHEEL_RATE, STEP, WHEEL_RADIUS, WHEEL_SEPARATION
from course_kit.robots.robot.world import Floats, Place


def wheel_rates(linear: float, angular: float) -> tuple[float, float]:
    """The rates (left, right, rad/s) that drive at `linear` m/s and `angular` rad/s, within the robot's limits.

    What the wheels cannot do together is driven slower, on the same circle. ValueError for nan and inf.
    """
    if not (math.isfinite(linear) and math.isfinite(angular)):
        raise ValueError(f"A velocity is finite, in m/s and rad/s, not {linear} and {angular}.")
    linear = max(-MAX_LINEAR, min(MAX_LINEAR, linear))
    angular = max(-MAX_ANGULAR, min(MAX_ANGULAR, angular))
    aside = angular * WHEEL_SEPARATION / 2
    left, right = (linear - aside) / WHEEL_RADIUS, (linear + aside) / WHEEL_RADIUS
    slower = min(1.0, MAX_WHEEL_RATE / max(abs(left), abs(right), MAX_WHEEL_RATE))
    return left * slower, right * slower


class Odometry:
    """Where the robot takes itself to be after its wheels alone; it drifts, for wheels slip and no two are the same.

    `place` is x, y in m and heading in rad (-π to π) in the frame `odom`, `twist` forward m/s and turning rad/s.
    """

    def __init__(self, place: Place = (0.0, 0.0, 0.0), angles: Sequence[float] | Floats = (0.0, 0.0)) -> None:
        self.place: Place = place
        self.twist = (0.0, 0.0)
        self._angles = (float(angles[0]), float(angles[1]))

    def update(self, angles: Sequence[float] | Floats, elapsed: float = STEP) -> None:
        """Take in how far the wheels (left, right) have turned in all, rad, `elapsed` s after the last time."""
        left, right = ((float(new) - old) * WHEEL_RADIUS for new, old in zip(angles, self._angles, strict=True))
        self._angles = (float(angles[0]), float(angles[1]))
        way, turn = (left + right) / 2, (right - left) / WHEEL_SEPARATION
        x, y, heading = self.place
        middle = heading + turn / 2
        # The chord of the arc; without the factor a turn of 0.1 rad between updates is 0.04 % too long.
        chord = way * (math.sin(turn / 2) / (turn / 2) if turn else 1.0)
        turned = math.remainder(heading + turn, math.tau)
        self.place = (x + chord * math.cos(middle), y + chord * math.sin(middle), turned)
        if elapsed > 0:
            self.twist = (way / elapsed, turn / elapsed)
