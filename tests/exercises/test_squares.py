"""Squares that are driven: how they lie does not count, their angles, sides and turns do."""

from __future__ import annotations

import math
from types import SimpleNamespace

import pytest

from course_kit.exercises.checker import squares

TICK = 0.016


def driven(corners: int, side: float, speed: float = 1.0, rate: float = 1.5, heading: float = 0.0) -> list:
    """The poses of a bit more than a lap along a polygon."""
    poses, x, y, theta = [], 0.0, 0.0, heading

    def tick(linear: float, angular: float) -> None:
        nonlocal x, y, theta
        theta += angular * TICK
        x, y = x + linear * TICK * math.cos(theta), y + linear * TICK * math.sin(theta)
        poses.append(SimpleNamespace(x=x, y=y, theta=theta, linear_velocity=linear, angular_velocity=angular))

    for _ in range(corners):
        for _ in range(round(side / speed / TICK)):
            tick(speed, 0.0)
        for _ in range(round(math.tau / corners / rate / TICK)):
            tick(0.0, rate)
    for _ in range(round(side / 2 / speed / TICK)):
        tick(speed, 0.0)
    return poses


@pytest.mark.parametrize("heading", [0.0, 0.4, math.pi / 4, 2.0])
@pytest.mark.parametrize("side_of_turns", ["left", "right"])
def test_a_square_is_one_however_it_lies(heading: float, side_of_turns: str) -> None:
    lap = driven(4, 1.5, heading=heading)
    if side_of_turns == "right":
        lap = mirrored(lap)
    assert squares.is_square(lap, 1.5)
    assert squares.extent(lap) == pytest.approx((1.5, 1.5), abs=0.1)
    assert not squares.is_square(lap, 1.0) and not squares.is_square(lap, 2.2)


def mirrored(poses: list) -> list:
    changes = [{"y": -p.y, "theta": -p.theta, "angular_velocity": -p.angular_velocity} for p in poses]
    return [SimpleNamespace(**{**vars(pose), **change}) for pose, change in zip(poses, changes, strict=True)]


@pytest.mark.parametrize("corners", [3, 5, 6])
def test_other_polygons_are_none(corners: int) -> None:
    assert not any(squares.is_square(driven(corners, 1.0), side) for side in (0.8, 1.0, 1.5, 2.0))


def test_the_rates_of_its_turns_are_found() -> None:
    assert squares.turns(driven(4, 1.0, rate=0.5)) == pytest.approx([0.5] * 4)
    assert squares.turns([]) == [] and squares.extent([]) == (0.0, 0.0)
    assert "it made no turn" in squares.described([])
