"""Tells turtles that were driven by commands from turtles that were put somewhere. No ROS.

Poses and commands are what was heard of them: when (nanoseconds since the epoch) and the message, oldest first.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

from course_kit.robots.turtlesim.paths import Point
from course_kit.robots.turtlesim.turtle import COMMAND_LIFETIME, TICK

Arrivals = Sequence[tuple[int, Any]]
SECOND = 1_000_000_000  # nanoseconds
SPARE_TICKS = 0.5  # by which the clock may be wrong
CARRIED = 0.25  # metres without a velocity for them that are no teleport yet: poses may come late or be lost
SAME_SPEED = 1e-3  # of a speed, and metres a second
ARRIVAL = SECOND  # by which poses and commands may pass one another on a busy machine


class Step(NamedTuple):
    """From one pose to the next."""

    when: int  # nanoseconds since the epoch
    pose: Any  # at its end
    length: float  # metres
    carried: float  # those of them that its velocity does not explain


def steps_of(poses: Arrivals) -> list[Step]:
    """The steps of a path."""
    steps = []
    for (before, a), (now, b) in pairwise(poses):
        length = math.dist((a.x, a.y), (b.x, b.y))
        ticks = max(1.0, (now - before) / SECOND / TICK) + SPARE_TICKS  # several, where poses were lost
        reach = max(abs(a.linear_velocity), abs(b.linear_velocity)) * TICK * ticks
        steps.append(Step(now, b, length, max(0.0, length - reach)))
    return steps


def drives(steps: Sequence[Step]) -> list[list[Any]]:
    """The poses of the steps, cut where the turtle was put elsewhere: at once, or little by little."""
    parts: list[list[Any]] = [[]]
    carried = 0.0
    for step in steps:
        carried += step.carried
        if not carried <= CARRIED:
            parts.append([])
            carried = 0.0
        parts[-1].append(step.pose)
    return parts


def carried(steps: Iterable[Step]) -> float:
    """Metres that the turtle was put on, not driven."""
    return sum(step.carried for step in steps)


def came_to(drive: Sequence[Any], point: Point, within: float) -> bool:
    """Return True if a drive came near a point from farther away (metres)."""
    was_away = False
    for pose in drive:
        if math.dist((pose.x, pose.y), point) > within:
            was_away = True
        elif was_away:
            return True
    return False


def moved_since(steps: Iterable[Step], when: float) -> float:
    """Metres moved after a moment (nanoseconds), in whatever way."""
    return sum(step.length for step in steps if step.when > when)


class Commands:
    """Which speeds were commanded when, by what was heard on a turtle's cmd_vel."""

    def __init__(self, heard: Arrivals, newcomers: Iterable[int] = ()) -> None:
        """`newcomers`: when publishers appeared. What they say first is seldom heard: they are not found yet."""
        self.times = [when for when, _ in heard]
        self._spans: dict[float, list[list[int]]] = {}  # by speed: from the first to the last of equal commands
        previous: set[float] = set()
        for when, twist in heard:
            # Sideways only where the simulator is holonomic.
            speeds = {abs(twist.linear.x), math.hypot(twist.linear.x, twist.linear.y)}
            for speed in speeds:
                spans = self._spans.setdefault(speed, [])
                if speed in previous:
                    spans[-1][1] = when
                else:
                    spans.append([when, when])
            previous = speeds
        self._speeds = sorted(self._spans)
        self._newcomers = [[when, when] for when in sorted(newcomers)]

    def explain(self, when: int, speed: float) -> bool:
        """Return True if a turtle's speed may come from one of them."""
        if _holds(self._newcomers, when):
            return True
        speed = abs(speed)
        near = SAME_SPEED * (1.0 + speed)
        fitting = self._speeds[bisect_left(self._speeds, speed - near) : bisect_right(self._speeds, speed + near)]
        return any(_holds(self._spans[one], when) for one in fitting)

    def first_effect(self, since: int) -> float:
        """From when on (nanoseconds) a turtle moves because of commands that came after `since`."""
        place = bisect_right(self.times, since)
        newcomers = [when for when, _ in self._newcomers if when <= since]  # what they said may not have been heard
        earlier, later = [*self.times[:place][-1:], *newcomers[-1:]], self.times[place:]
        over = max(since, max(earlier) + COMMAND_LIFETIME + ARRIVAL) if earlier else since
        return min(over, later[0]) if later else over


def _holds(spans: list[list[int]], when: int) -> bool:
    """Return True if one of the spans, or the second after it in which its command holds, has this moment in it."""
    place = bisect_right(spans, when + ARRIVAL, key=lambda span: span[0])
    return place > 0 and when <= spans[place - 1][1] + COMMAND_LIFETIME + ARRIVAL


def driven(steps: Iterable[Step], commands: Commands | None = None) -> float:
    """Metres that the turtle drove by its velocity; with `commands`, those that they explain."""
    return sum(
        step.length - step.carried
        for step in steps
        if step.length > step.carried and (commands is None or commands.explain(step.when, step.pose.linear_velocity))
    )
