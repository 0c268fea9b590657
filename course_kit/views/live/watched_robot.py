"""One robot that a view shows: what its topics tell, and, if its node runs here, what is true."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from typing import TYPE_CHECKING

from course_kit.robots.robot.picture import Seen
from course_kit.robots.robot.world import Place
from course_kit.views.live.robot_topics import RobotTopics
from course_kit.views.live.seen_robot import in_numbers

if TYPE_CHECKING:
    from course_kit.robots.robot.node import Robot

LOOK = 0.5  # s between two looks in the graph at whether it is still there


class WatchedRobot:
    """A robot, given as its node or as its namespace."""

    def __init__(self, robot: Robot | str) -> None:
        self._vehicle = None if isinstance(robot, str) else robot.vehicle
        self.namespace = robot if isinstance(robot, str) else robot.get_namespace()
        self.topics = RobotTopics(self.namespace)
        self.trail = self.topics.robot.trail
        self._is_there, self._looked_at = False, -math.inf
        if self._vehicle is not None:
            self.trail.replace(list(self._vehicle.trail))

    @property
    def number(self) -> int | None:
        """Its number in the simulation, if that is known here."""
        return None if self._vehicle is None else self._vehicle.number

    def look(self, places: Mapping[int, Place]) -> Seen | None:
        """The robot as it is now; None if it is not there. `places` are the true ones by number."""
        truth = places.get(self._vehicle.number) if self._vehicle is not None else None
        now = time.monotonic()
        if now - self._looked_at >= LOOK:
            self._looked_at, self._is_there = now, self.topics.is_there
        self.topics.take()
        # Of a robot that was stopped it is not known where in the world another one of its name is.
        if truth is None and (self._vehicle is not None or not self._is_there):
            return None
        self.topics.robot.look(truth)
        return self.topics.robot.seen()

    def in_numbers(self, seen: Seen) -> str:
        """A line that says where it is, how far beside it takes itself to be, and what it has bumped into."""
        line = f"{seen.name}  {in_numbers(seen.place)}"
        if seen.estimate is not None:
            way = math.dist(seen.place[:2], seen.estimate[:2])
            turn = math.remainder(seen.estimate[2] - seen.place[2], math.tau)
            line += f"; estimate {way:.2f} m and {abs(turn):.2f} rad beside"
        return line + self._bumps()

    def _bumps(self) -> str:
        if self._vehicle is None:
            return f"; touches a {self.topics.touches}" if self.topics.touches else ""
        count = self._vehicle.bumps
        if not count:
            return ""
        return f"; {count} bump{'s' if count > 1 else ''}, the last into a {self._vehicle.last_bumps[-1].what}"

    def absence(self) -> str:
        """Why it is not there."""
        if self._vehicle is not None:
            return f"{self.topics.robot.name} was stopped. Run the view's cell again to see another one."
        return f"No robot: no node publishes {self.topics.odometry}. run(Robot) starts one."
