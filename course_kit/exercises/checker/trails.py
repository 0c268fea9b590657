"""The lines that the turtles of a checker's world draw, and how much of a star is there. No ROS."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from course_kit.robots.turtlesim.field import EXTENT, MIDDLE
from course_kit.robots.turtlesim.paths import Point, star

YELLOW = (255, 255, 0)
RADIUS = 4.0  # metres
NEAR = 0.15  # metres from where a line should be that still count as on it
STRAY = 0.25  # metres from every line from which on something else is drawn
LIFTED = 1.0  # metres from the end of one line to the beginning of the next from which on the pen was lifted
STEP = 0.05  # metres between two points of a line that are looked at
LINES = list(pairwise(star((MIDDLE, MIDDLE), RADIUS)))
LENGTH = sum(math.dist(*line) for line in LINES)
Points = npt.NDArray[np.float64]  # one a row


class Line(NamedTuple):
    """A line that was drawn: metres, with y upwards."""

    start: Point
    end: Point
    color: tuple[int, int, int]
    width: int  # pixels


class Place(NamedTuple):
    """Where a turtle is: metres, radians."""

    x: float
    y: float
    theta: float


def place(world: Any) -> Place | None:
    """Where turtle1 of a world is; None if there is none."""
    turtle = world.turtles.get("turtle1")
    return None if turtle is None else Place(turtle.x, EXTENT - turtle.depth, turtle.theta)


class Drawing:
    """The lines that are drawn in a world from now on."""

    def __init__(self, world: Any) -> None:
        self.lines: list[Line] = []
        self._draw_line = world.field.draw_line
        world.field.draw_line = self._note

    def _note(self, start: Point, end: Point, color: tuple[int, int, int], width: int) -> None:
        self.lines.append(Line((start[0], EXTENT - start[1]), (end[0], EXTENT - end[1]), color, width))
        self._draw_line(start, end, color, width)


@dataclass(frozen=True)
class StarSeen:
    """What there is of the star."""

    complete: int  # lines, of 5, in whatever colour
    yellow: int  # of these
    widths: tuple[int, ...]  # pixels, of what was drawn of it
    strokes: int  # 1 if the pen was never lifted on the way
    again: float  # metres of it that were drawn twice
    elsewhere: float  # metres that were drawn beside it


def star_seen(lines: Sequence[Line]) -> StarSeen:
    """Look at lines in the order in which they were drawn."""
    parts = [_points_on(line.start, line.end) for line in lines]
    off = [_distances(part, LINES) for part in parts]
    of_star = [line for line, away in zip(lines, off, strict=True) if away.max() <= NEAR and line.start != line.end]
    drawn = [(line.start, line.end) for line in of_star]
    yellow = [(line.start, line.end) for line in of_star if line.color == YELLOW]
    return StarSeen(
        complete=_complete(drawn),
        yellow=_complete(yellow),
        widths=tuple(sorted({line.width for line in of_star})),
        strokes=sum(math.dist(before.end, after.start) > LIFTED for before, after in pairwise(of_star)) + bool(of_star),
        again=max(0.0, sum(math.dist(*line) for line in drawn) - LENGTH),
        elsewhere=sum(
            math.dist(line.start, line.end) * float((away > STRAY).mean())
            for line, away in zip(lines, off, strict=True)
        ),
    )


def _complete(drawn: Sequence[tuple[Point, Point]]) -> int:
    """How many lines of the star have something drawn near them all along."""
    return sum(bool(drawn) and bool((_distances(_points_on(*line), drawn) <= NEAR).all()) for line in LINES)


def _points_on(start: Point, end: Point) -> Points:
    shares = np.linspace(0.0, 1.0, max(2, math.ceil(math.dist(start, end) / STEP) + 1))[:, None]
    return np.asarray(start) * (1 - shares) + np.asarray(end) * shares


def _distances(points: Points, lines: Sequence[tuple[Point, Point]]) -> npt.NDArray[np.float64]:
    """Metres from each point to the nearest of some lines."""
    nearest = np.full(len(points), np.inf)
    for start, end in lines:
        along = np.subtract(end, start)
        length = float(along @ along)
        share = np.clip((points - start) @ along / length, 0.0, 1.0) if length else np.zeros(len(points))
        nearest = np.minimum(nearest, np.hypot(*(points - start - share[:, None] * along).T))
    return nearest
