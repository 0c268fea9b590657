"""Maps that a check draws, to plan on: with walls to go around, gaps that are too narrow, and places out of reach.

Pure: no ROS. Cells are those of navigation.grid_map: -1 unknown, 65 and more occupied.
"""

from __future__ import annotations

from dataclasses import dataclass
from random import Random

import numpy as np

from course_kit.robots.navigation.grid_map import Cells, GridMap
from course_kit.robots.navigation.places import Floats

WIDTH, HEIGHT = 4.6, 3.0  # metres
RESOLUTIONS = (0.04, 0.05, 0.06)
WALL = 0.12  # metres
SLIT = 0.13  # metres of a gap that a point could take, and no robot
Point = tuple[float, float]


@dataclass(frozen=True, eq=False)
class DrawnMap:
    """A map, where a path leads from and to, and goals to which there is none: in a wall, shut in, outside."""

    map: GridMap
    start: Point
    goal: Point
    in_wall: Point
    shut_in: Point
    outside: Point


def draw(random: Random) -> DrawnMap:
    """A room with a cup, open to the start, that lies across the straight way to the goal; mirrored by chance."""
    side = random.choice(RESOLUTIONS)
    origin = random.uniform(-6, -2), random.uniform(1, 4)
    cells: Cells = np.zeros((round(HEIGHT / side), round(WIDTH / side)), np.int8)
    x, y = np.meshgrid((np.arange(cells.shape[1]) + 0.5) * side, (np.arange(cells.shape[0]) + 0.5) * side)

    def fill(x0: float, y0: float, x1: float, y1: float, value: int = 100) -> None:
        cells[(x >= x0) & (x < x1) & (y >= y0) & (y < y1)] = value

    edge_x, edge_y = cells.shape[1] * side, cells.shape[0] * side
    fill(0, 0, edge_x, edge_y)
    fill(WALL, WALL, edge_x - WALL, edge_y - WALL, 0)
    # The cup: its bottom east, its arms west; the start lies before its mouth, the goal beyond its bottom.
    bottom = random.uniform(2.4, 2.7)
    low, high = random.uniform(0.65, 0.8), random.uniform(2.35, 2.45)
    fill(bottom - 1.3, low, bottom, low + WALL, 65)
    fill(bottom - 1.3, high - WALL, bottom, high, 70)
    fill(bottom, low, bottom + WALL, high)
    slit = random.uniform(1.4, 1.6)  # in its bottom
    fill(bottom, slit, bottom + WALL, slit + SLIT, 0)
    # What nobody has seen closes the shorter way round, one without a wall before it.
    fill(bottom - 0.9, 0.0, bottom - 0.4, low, -1)
    # A small room that is shut.
    fill(3.65, 0.55, 4.25, 1.15)
    fill(3.75, 0.65, 4.15, 1.05, 0)
    # Free is all below 65, be it sure or not.
    is_free = cells == 0
    cells[is_free] = np.random.default_rng(random.randrange(2**32)).integers(0, 65, is_free.sum())
    points = [
        (random.uniform(0.5, 0.7), random.uniform(1.2, 1.35)),
        (random.uniform(3.7, 4.1), random.uniform(1.4, 1.5)),
        (bottom + WALL / 2, high - 0.4),
        (3.95, 0.85),
        (edge_x + random.uniform(0.5, 2.0), random.uniform(0.5, 3.0)),
    ]
    array: Floats = np.array(points)
    if random.random() < 0.5:
        cells, array = cells[::-1], np.column_stack([array[:, 0], edge_y - array[:, 1]])
    if random.random() < 0.5:
        cells, array = cells[:, ::-1], np.column_stack([edge_x - array[:, 0], array[:, 1]])
    named = [(float(px), float(py)) for px, py in array + np.array(origin)]
    return DrawnMap(GridMap(np.ascontiguousarray(cells), side, origin), *named)
