"""One robot of a simulation: what it was told, where its wheels say it is, what it bumped into. No ROS."""

from __future__ import annotations

import math
from collections import deque
from typing import NamedTuple

from course_kit.robots.robot.drive import Odometry, wheel_rates
from course_kit.robots.robot.world import Place

FREE = 0.2  # s without touching anything, after which it is free: wheels that push have the body bounce
KEPT_BUMPS = 1000
STRIDE, KEPT_STRIDES = 0.05, 4000  # m between two points of its trail, and how many of them are kept
BEHIND = 0.5  # s of simulated time by which the correction of its odometry may be too old before time goes slowly
SILENT = 5.0  # s of simulated time, after which nobody corrects it any more


class Bump(NamedTuple):
    """At a simulated time (s) it bumped into a "wall", a "pillar" or a "robot"."""

    time: float
    what: str


class Vehicle:
    """What is known of one robot beside its physics; `number` tells it from the others, and is never used again."""

    def __init__(self, number: int, place: Place, timeout: float, patience: float) -> None:
        self.number = number
        self.timeout = timeout  # s of simulated time, after which a command holds no more
        self.patience = patience  # s of real time that the second half of that takes at least
        self.odometry = Odometry()
        self.touching = ""  # what it touches now, or touched a moment ago
        self.bumps = 0  # how often it has bumped into something
        self.last_bumps: deque[Bump] = deque(maxlen=KEPT_BUMPS)
        self.trail: deque[tuple[float, float]] = deque([place[:2]], maxlen=KEPT_STRIDES)  # m, where it has truly been
        self.watchdog_stops = 0  # how often it was stopped because no command came
        self._command = (0.0, 0.0, -math.inf)  # m/s, rad/s, and when it came
        self._corrected = (-math.inf, -math.inf)  # until when, and when that was told
        self._touched = -math.inf  # when it last touched anything

    def command(self, linear: float, angular: float, time: float) -> None:
        """Drive at `linear` m/s and `angular` rad/s from now on, until the watchdog stops it. From any thread."""
        self._command = (linear, angular, time)  # one assignment: who steps sees the old command or the new one

    def correct(self, until: float, time: float) -> None:
        """Note at `time` that tf tells where its odometry lies until `until`, both in s. From any thread."""
        if until != self._corrected[0]:
            self._corrected = until, time

    def rates(self, time: float) -> tuple[float, float]:
        """The rates that its wheels should have now, rad/s, left and right; none if its command is too old."""
        command = linear, angular, came = self._command
        if time - came <= self.timeout + 1e-9:
            return wheel_rates(linear, angular)
        if (linear or angular) and self._command is command:
            self._command = (0.0, 0.0, came)
            self.watchdog_stops += 1
        return 0.0, 0.0

    def slows(self, time: float) -> float:
        """How many s of real time a simulated s takes at least: more than 0 while somebody is late."""
        linear, angular, came = self._command
        if (linear or angular) and time - came >= self.timeout / 2:
            return 2 * self.patience / self.timeout
        until, told = self._corrected
        # Whoever corrects it works through what it has heard, as fast as on a real robot.
        return 1.0 if self.patience and until < time - BEHIND and time - told < SILENT else 0.0

    def note(self, time: float, place: Place, touches: str) -> None:
        """Take in where it truly is after a step, and what it touches."""
        if touches:
            if not self.touching:
                self.bumps += 1
                self.last_bumps.append(Bump(time, touches))
            self.touching, self._touched = touches, time
        elif time - self._touched > FREE:
            self.touching = ""
        if math.dist(place[:2], self.trail[-1]) >= STRIDE:
            self.trail.append(place[:2])
