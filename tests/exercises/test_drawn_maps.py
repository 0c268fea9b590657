"""The maps on which robot-7 is checked: each mistake that the exercise is about leads to another path."""

from __future__ import annotations

from random import Random

import numpy as np
import pytest

from course_kit.exercises.checker.drawn_maps import DrawnMap, Point, draw
from course_kit.exercises.robot.robot_7_path import RADIUS, free
from course_kit.robots.navigation.grid_map import OCCUPIED, UNKNOWN
from course_kit.robots.navigation.planning import length, shortest

of_many = pytest.mark.parametrize("drawn", [draw(Random(seed)) for seed in range(12)])


def way(drawn: DrawnMap, allowed: np.ndarray, goal: Point | None = None) -> float | None:
    """Metres of the shortest way over allowed cells; None if there is none."""
    rows, columns = drawn.map.cells_of(np.array([drawn.start, goal or drawn.goal]))
    ends = list(zip(rows.tolist(), columns.tolist(), strict=True))
    cells = shortest(np.where(allowed, 1.0, np.inf), *ends)
    return None if cells is None else length(drawn.map.centres(*np.array(cells).T))


@of_many
def test_there_is_a_way_and_none_to_what_is_out_of_reach(drawn: DrawnMap) -> None:
    assert way(drawn, free(drawn.map))
    assert way(drawn, free(drawn.map), drawn.shut_in) is None
    assert drawn.map.at(np.array([drawn.in_wall, drawn.outside])).tolist() == [100, UNKNOWN]


@of_many
def test_a_point_and_who_drives_into_the_unknown_find_shorter_ways(drawn: DrawnMap) -> None:
    right = way(drawn, free(drawn.map))
    as_a_point = way(drawn, (drawn.map.cells < OCCUPIED) & (drawn.map.cells != UNKNOWN))
    through_unknown = way(drawn, drawn.map.to_wall >= RADIUS)
    assert right and as_a_point and through_unknown
    assert max(as_a_point, through_unknown) < right - 0.1
