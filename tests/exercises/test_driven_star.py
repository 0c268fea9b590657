"""The judging of a driven star: its shape, and the metres that its result tells."""

from __future__ import annotations

import math
from itertools import accumulate, pairwise
from types import SimpleNamespace

import pytest
from action_msgs.msg import GoalStatus
from turtlesim.msg import Pose

from course_kit.exercises.actions.star_driven import Star
from course_kit.exercises.checker.action_assertions import Goal

SIDE = 1.2
TICK = 16_000_000  # nanoseconds


def corners(turn: float, side: float) -> list[tuple[float, float]]:
    """Of five lines, with so many turns from each to the next."""
    headings = [number * turn * math.tau for number in range(5)]
    x = accumulate((side * math.cos(heading) for heading in headings), initial=5.0)
    y = accumulate((side * math.sin(heading) for heading in headings), initial=5.0)
    return list(zip(x, y, strict=True))


def driven(points: list[tuple[float, float]], distance: float) -> Star:
    """A star of SIDE that succeeded with a distance, along these points."""
    places = [
        (a[0] + (b[0] - a[0]) * part / 50, a[1] + (b[1] - a[1]) * part / 50)
        for a, b in pairwise(points)
        for part in range(1, 51)
    ]
    poses = [Pose(x=x, y=y, linear_velocity=2.0) for x, y in [points[0], *places]]
    goal = Goal(None, None, accepted=True, status=GoalStatus.STATUS_SUCCEEDED)  # type: ignore[arg-type]
    goal.result = SimpleNamespace(distance=distance)
    arrivals = [(number * TICK, pose) for number, pose in enumerate(poses)]
    # It coasts for a line's time until it begins.
    return Star(SIDE, goal, 0, other_ended=50 * TICK, arrivals=arrivals)


@pytest.mark.parametrize(("distance", "is_right"), [(6.0, True), (7.2, True), (9.0, False), (4.8, False)])
def test_the_metres_of_the_drawing_and_those_that_were_measured_are_right(distance, is_right):
    star = driven([(3.8, 5.0), *corners(2 / 5, SIDE)], distance)  # 1.2 m before it began
    assert star.is_drawn(1.5) and not star.is_drawn()
    assert star.is_finished == is_right


@pytest.mark.parametrize("distance", [6.0, 7.2])
def test_measured_metres_of_what_is_no_star_are_not_right(distance):
    pentagon = driven(corners(1 / 5, 1.2 * SIDE), distance)
    assert not pentagon.is_drawn(1.5)
    assert pentagon.is_finished == (distance == 6.0)


@pytest.mark.parametrize(("lines_told", "is_right"), [(4, True), (0, False)])
def test_feedback_is_held_against_the_lines_where_the_turtle_went_astray(lines_told, is_right):
    """As on a busy machine: at each corner of a pentagon it overshoots by a line and drives back."""
    places = corners(1 / 5, SIDE)
    ends = [(2 * b[0] - a[0], 2 * b[1] - a[1]) for a, b in pairwise(places)]
    astray = driven([places[0], *(point for pair in zip(ends, places[1:], strict=True) for point in pair)], 6.0)
    assert not astray.is_drawn(1.5)
    mine = SimpleNamespace(uuid=[1])
    told = []
    for number, (when, pose) in enumerate(astray.arrivals[1:]):
        line = number // 100
        left = math.dist((pose.x, pose.y), places[line + 1]) + SIDE * min(lines_told, 4 - line)
        told.append((when, SimpleNamespace(goal_id=mine, feedback=SimpleNamespace(distance_left=left))))
    astray.goal.heard, astray.goal.handle = SimpleNamespace(arrivals=told), SimpleNamespace(goal_id=mine)
    assert (astray.wrong_feedback < SIDE / 2 + 0.3) == is_right
