"""One journey of a robot to a goal: follow the path, stop before what is in the way, ask for another path, arrive.

No ROS and no clock of its own: Navigator makes it an action, the tests drive the physics with it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from course_kit.robots.navigation.places import Floats, Place, between, wrapped
from course_kit.robots.navigation.planning import CostMap
from course_kit.robots.navigation.pursuit import Limits, Pursuit, room_ahead, turn

# Error codes as those of Nav2's controllers.
FAILED_TO_MAKE_PROGRESS = 105
CLOSE, STRAIGHT = 0.05, 0.05  # m and rad from the goal at which it is reached
LOST = 0.5  # metres from its path at which a robot wants another
PATIENCE = 10.0  # seconds for PROGRESS metres or TURNED rad, else the robot is stuck
TICKED = 0.5  # seconds from tick to tick that count for that, at most: in longer ones tf or the laser were missing
PROGRESS, TURNED = 0.1, 0.5
BLOCKED = 1.0  # seconds before what is in the way until it wants another path
AGAIN = 2.0  # seconds between two wishes


@dataclass(frozen=True)
class End:
    """How a journey ended; if not at its goal, with Nav2's code for what went wrong, and one sentence."""

    arrived: bool
    code: int = 0
    why: str = ""


class Journey:
    """A robot on its way to a goal; give it a path by follow(), then tick() says how to drive."""

    def __init__(self, goal: Place, limits: Limits) -> None:
        self.goal = goal
        self.limits = limits
        self.end: End | None = None
        self.paths = 0  # that it was given
        self._pursuit: Pursuit | None = None
        self._arrived = False  # at the goal's place; the heading is still to come
        self._wants = True  # another path
        self._asked = -math.inf  # when it last said so
        self._blocked_since: float | None = None
        self._waits = False  # for the path that it wants
        self._ticked = math.inf  # when the last tick was
        self._came: Place | None = None  # where there was progress
        self._stood = 0.0  # seconds since then, but for those in which the robot waited for others

    def follow(self, path: Floats) -> None:
        """Take this path, shape (n, 2), from now on."""
        self._pursuit, self._wants, self._blocked_since = Pursuit(path, self.limits), False, None
        self._waits = False
        self.paths += 1

    def refuse(self) -> None:
        """There is no path now; it will ask again."""
        self._waits = False

    def fail(self, code: int, why: str) -> None:
        """End without having arrived."""
        self.end = self.end or End(False, code, why)

    def wants_path(self, now: float) -> bool:
        """Return True if it is time to look for a path, every AGAIN seconds at most."""
        if self._arrived or not self._wants or now < self._asked + AGAIN:
            return False
        self._asked, self._waits = now, True
        return True

    def check(self, cost_map: CostMap, place: Place) -> None:
        """Look whether the path is still free on a newer map."""
        if self._pursuit is not None and not self._arrived:
            left = self._pursuit.left()
            # Where the robot is it may be too near to a wall, and leaves.
            away = np.hypot(*(left - np.array(place[:2])).T) > self.limits.radius
            if not cost_map.is_free(left[away]).all():
                self._wants = True

    def remaining(self, place: Place) -> float:
        """Metres still to drive, as far as is known."""
        return self._pursuit.remaining(place) if self._pursuit else math.dist(place[:2], self.goal[:2])

    def tick(self, now: float, place: Place, points: Floats) -> tuple[float, float]:
        """How to drive, m/s and rad/s, from a place in the map; `points`: the scan, seen from the robot, (n, 2)."""
        if self.end is not None or self._pursuit is None:
            return 0.0, 0.0
        self._arrived = self._arrived or math.dist(place[:2], self.goal[:2]) < CLOSE
        if self._arrived:
            self._pursuit.pass_points(place)
            off = wrapped(self.goal[2] - place[2])
            if abs(off) < STRAIGHT:
                self.end = End(True)
                return 0.0, 0.0
            return 0.0, turn(off, self.limits)
        self._look_at_progress(now, place)
        beside = float(np.hypot(*points.T).min()) if len(points) else math.inf
        room = room_ahead(points, self.limits)
        speed, turning = self._pursuit.command(place, room, beside)
        self._look_ahead(now, place, room, speed)
        if self.end is not None:
            return 0.0, 0.0
        return speed, turning

    def _look_ahead(self, now: float, place: Place, room: float, speed: float) -> None:
        """Want another path when something is in the way for a while, or the robot is far from its path."""
        assert self._pursuit is not None
        if room >= self.limits.stop + 0.02 or speed > 0.02:
            self._blocked_since = None
        elif self._blocked_since is None:
            self._blocked_since = now
        blocked = self._blocked_since is not None and now - self._blocked_since > BLOCKED
        if blocked or math.dist(place[:2], self._pursuit.left()[0]) > LOST:
            self._wants = True

    def _look_at_progress(self, now: float, place: Place) -> None:
        """Fail when the robot neither drives nor turns for a while; that it waits for a path does not hold it."""
        passed, self._ticked = now - self._ticked, now
        step = between(self._came or place, place)
        if self._came is None or math.hypot(step[0], step[1]) > PROGRESS or abs(step[2]) > TURNED:
            self._came, self._stood = place, 0.0
        elif not self._waits:
            self._stood += min(max(passed, 0.0), TICKED)
        if self._stood > PATIENCE:
            why = f"the robot has not come on for {PATIENCE:g} s: something that the laser sees or not holds it"
            self.fail(FAILED_TO_MAKE_PROGRESS, why)
