"""Hints of the check of robot-4 for maps that are wrong."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from course_kit.exercises.checker.judged_maps import CELL, cause
from course_kit.robots.navigation.grid import Grid
from course_kit.robots.navigation.grid_map import GridMap
from course_kit.robots.navigation.places import Floats
from course_kit.robots.robot.world import World
from course_kit.robots.robot.worlds import world

ANGLES: Floats = np.radians(np.arange(360.0))
REACH = 2.2  # m
ELSEWHERE = (0.62, -1.87)  # m, where the origin of a map is not


def map_from(flat: World, places: Sequence[tuple[float, float]]) -> GridMap:
    """The map that a laser makes that sees a flat from some places."""
    grid = Grid(CELL)
    for x, y in places:
        for _ in range(3):  # of one scan alone nothing is sure
            grid.add((x, y, 0.0), ANGLES, flat.distances(x, y, ANGLES, REACH), REACH)
    return grid.map()


@pytest.mark.parametrize("name", ["rooms", "office"])
@pytest.mark.parametrize("seed", range(8))
def test_a_map_that_is_shifted_is_told_so_also_where_some_of_it_lacks(name: str, seed: int) -> None:
    flat = world(name, seed)
    places = [flat.start[:2], *flat.goals]
    seen, reference = map_from(flat, places[:-1]), map_from(flat, places)
    x, y = (has + more for has, more in zip(seen.origin, ELSEWHERE, strict=True))
    why = cause(GridMap(seen.cells, CELL, (x, y)), flat, reference, [], reference)
    assert why.startswith("It is shifted by (0.62, -1.87) m")
