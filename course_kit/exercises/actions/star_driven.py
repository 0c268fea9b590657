"""The star of actions-5 as the turtle drove it: its shape, and what result and feedback say of it."""

from __future__ import annotations

import math
import statistics
from dataclasses import dataclass, field
from functools import cached_property
from itertools import accumulate, pairwise
from typing import Any

import numpy as np

from course_kit.exercises.checker.action_assertions import Goal
from course_kit.robots.turtlesim import paths

OFF = 0.25  # metres by which a point of the star may be missed
CLEARLY_AWAY = 0.45  # metres from where it began at which it is cancelled
LONGER = 0.15  # the part by which the way may be longer or shorter than five lines
COASTED = 1.5  # metres that the turtle may go on before it begins a star in the midst of another
CARRIED = 0.3  # metres without a velocity: those of teleports
NOTICED = 300_000_000  # nanoseconds from the end of a goal to where the one that has pre-empted it begins
BEGINS = 1_300_000_000  # the same where the turtle stands, or obeys its last command, until then


@dataclass
class Star:
    """A goal, and how the turtle moved until it ended."""

    side: float
    goal: Goal
    begun: int  # the number of the pose with which it was sent
    other_ended: int = 0  # when the star that it pre-empted was aborted (nanoseconds since the epoch)
    elsewhere: list[paths.Point] = field(default_factory=list)  # where it did not begin, and wrong ones may end
    arrivals: list[tuple[int, Any]] = field(default_factory=list)  # when each pose came, and the pose

    @property
    def lines(self) -> float:
        """The metres of its five lines."""
        return 5 * self.side

    @property
    def poses(self) -> list[Any]:
        """Where the turtle was."""
        return [pose for _, pose in self.arrivals]

    @property
    def seconds(self) -> float:
        """How long the goal took."""
        return (self.goal.ended or math.inf) - self.goal.sent

    @property
    def distance(self) -> float:
        """The metres that the result says."""
        return math.nan if self.goal.result is None else float(self.goal.result.distance)

    @property
    def is_finished(self) -> bool:
        """True if it succeeded, with the metres driven as the result: by the drawing, or as they were measured."""
        metres = [self.lines, paths.length(self.poses)] if self.is_drawn(COASTED) else [self.lines]
        wrong = min(abs(self.distance - way) for way in metres)
        return self.goal.word == "succeeded" and wrong < LONGER * self.lines

    @cached_property
    def missed_by(self) -> float:
        """How far the turtle stayed from a point of the star that ends where it ended, at most, in metres.

        Once its way is known to the end: it takes a tenth of a second.
        """
        return paths.star_missed_by(self.poses, (self.poses[-1].x, self.poses[-1].y), self.side)

    @property
    def beginnings(self) -> list[Any]:
        """Where it may have begun: where it was sent, or anywhere from there until it drove the turtle itself.

        A star that drives to `elsewhere` first may keep the same velocity all the way, so its way there is left out.
        """
        places = [self.poses[0]]
        for when, pose in self.arrivals[1:]:
            is_commanded = _velocities(pose) != _velocities(places[-1])
            if when > self.other_ended + (NOTICED if is_commanded else BEGINS):
                break
            places.append(pose)
        return places[:1] + [pose for pose in places[1:] if is_away(pose, self.elsewhere, CLEARLY_AWAY)]

    @property
    def gap(self) -> float:
        """Metres from where it ended to where it began, or to the nearest place where it may have begun."""
        end = self.poses[-1]
        return min(math.dist((pose.x, pose.y), (end.x, end.y)) for pose in self.beginnings)

    def is_drawn(self, coasted: float = 0.0) -> bool:
        """Return True if its way is a star that was driven, but for `coasted` metres before it began."""
        is_as_long = abs(paths.length(self.poses) - self.lines) < LONGER * self.lines + coasted
        return max(self.missed_by, self.gap) < OFF and is_as_long and paths.carried(self.poses) < CARRIED

    @property
    def wrong_feedback(self) -> float:
        """By how many metres the feedback was wrong at the median.

        Of the way to the end that was driven, or that without what a busy machine had the turtle overshoot.
        """
        times, poses = zip(*self.arrivals, strict=True)
        behind = [*accumulate((math.dist((a.x, a.y), (b.x, b.y)) for a, b in pairwise(poses)), initial=0.0)]
        left = [
            (behind[-1] - float(np.interp(when, times, behind)), said.distance_left) for when, said in self.goal.told
        ]
        if not left or not behind[-1]:
            return math.inf
        may_be_astray = behind[-1] > self.lines or self.is_drawn(COASTED)
        parts = [1.0, self.lines / behind[-1]] if may_be_astray else [1.0]
        return min(statistics.median(abs(way * part - said) for way, said in left) for part in parts)


def _velocities(pose: Any) -> tuple[float, float]:
    return pose.linear_velocity, pose.angular_velocity


def is_away(pose: Any, places: list[paths.Point], metres: float) -> bool:
    """Return True if a pose is more than so many metres from all of some places."""
    return all(math.dist((pose.x, pose.y), place) > metres for place in places)
