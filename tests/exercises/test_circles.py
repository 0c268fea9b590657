"""The circles in a driven path: where they part, and what is none."""

from __future__ import annotations

import math
from collections import namedtuple
from itertools import pairwise

import numpy as np
import pytest

from course_kit.exercises.checker import circles
from course_kit.exercises.checker.circles import two_circles
from course_kit.robots.turtlesim import paths

Pose = namedtuple("Pose", "x y theta linear_velocity", defaults=[1.0])
Poses = list[Pose]


def circle(turns: float, radius: float = 1.0) -> Poses:
    """Poses along a circle from (0, 0), to the east at first; negative turns go to the right."""
    side = math.copysign(1.0, turns)
    steps = np.linspace(0.0, turns * math.tau, 400)
    return [
        Pose(side * radius * math.sin(a), side * radius * (1 - math.cos(a)), math.remainder(a, math.tau)) for a in steps
    ]


def polygon(corners: int) -> Poses:
    angles = np.linspace(0.0, math.tau, corners + 1)
    ends = [(math.cos(angle), math.sin(angle)) for angle in angles]
    parts = np.linspace(0.0, 1.0, 50)
    return [Pose(a + (c - a) * p, b + (d - b) * p, 0.0) for (a, b), (c, d) in pairwise(ends) for p in parts]


def test_a_figure_of_eight_has_two_circles_of_opposite_sense():
    eight = [*circle(1), *circle(-1)]
    first, second = two_circles(eight)
    assert first.turned == pytest.approx(math.tau, abs=0.1) and second.turned == pytest.approx(-math.tau, abs=0.1)
    assert first.length == pytest.approx(second.length, rel=0.02)
    assert first.middle == pytest.approx((0.0, 1.0), abs=0.01) and second.middle == pytest.approx((0.0, -1.0), abs=0.01)
    assert max(first.error, second.error) < 0.01
    assert paths.gap(eight) == pytest.approx(0.0, abs=1e-6)


def test_a_circle_driven_twice_is_one_and_nothing():
    first, second = two_circles([*circle(1), *circle(1)])
    assert first.turned == pytest.approx(2 * math.tau, abs=0.1)
    assert second.length == pytest.approx(0.0, abs=0.1)


def test_turning_on_the_spot_and_coming_home_change_nothing():
    home = [Pose(0.0, 0.0, math.pi)] * 20 + [Pose(-0.02 * step, 0.0, math.pi) for step in range(8)]
    turning = [Pose(0.0, 0.0, 0.1 * step, 0.0) for step in range(60)]
    first, second = two_circles([*turning, *circle(-1), *turning, *circle(1), *home])
    assert (first.turned, second.turned) == pytest.approx((-math.tau, math.tau), abs=0.3)
    assert max(first.error, second.error) < 0.05


def test_corners_are_no_circle():
    errors = {corners: two_circles(polygon(corners))[0].error for corners in (3, 4, 5, 12)}
    assert min(errors[3], errors[4], errors[5]) > 0.1 > errors[12]


def test_what_stands_or_goes_straight_is_no_circle():
    line = [Pose(0.1 * step, 0.0, 0.0) for step in range(40)]
    for poses in ([], [Pose(0.0, 0.0, 0.0)] * 3, line):
        for one in two_circles(poses):
            assert one.error > 0.5 or one.turned == 0.0
    assert circles.turned_in_all(line) == 0.0


def test_a_jump_is_seen_and_a_lost_pose_is_none():
    drive = [Pose(0.032 * step, 0.0, 0.0, 2.0) for step in range(20)]
    assert not circles.has_jump(drive) and not circles.has_jump(drive[:9] + drive[10:])
    assert circles.has_jump([*drive, Pose(0.0, 0.0, 0.0, 0.0)])
