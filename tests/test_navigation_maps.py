"""Places, maps of scans and scan matching, against geometry: no ROS, no physics."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from course_kit.robots.navigation.grid import Grid
from course_kit.robots.navigation.grid_map import UNKNOWN, GridMap
from course_kit.robots.navigation.places import Floats, Place, after, between, hits, inverse, moved
from course_kit.robots.navigation.scan_matching import Slam, Walls, match
from course_kit.robots.robot.world import Pillar, Wall, World
from tests.crossing import ANGLES, NOISE, errors, rightness, true_map

LONGEST = 3.5
ROOM = World(
    "room",
    (
        Wall(0.0, 1.53, 4.1, 0.1), Wall(0.0, -1.53, 4.1, 0.1), Wall(2.03, 0.0, 3.1, 0.1, math.pi / 2),
        Wall(-2.03, 0.0, 3.1, 0.1, math.pi / 2), Wall(0.6, 1.0, 1.0, 0.1, math.pi / 2),
    ),
    (Pillar(-1.0, -0.5, 0.2),),
    (0.0, 0.0, 0.0),
    (),
)  # fmt: skip
CORRIDOR = World("corridor", (Wall(0.0, 0.5, 30.0, 0.1), Wall(0.0, -0.5, 30.0, 0.1)), (), (0.0, 0.0, 0.0), ())
numbers = st.floats(-10, 10)
places = st.tuples(numbers, numbers, st.floats(-math.pi, math.pi))


def scan(where: World, place: Place, random: np.random.Generator | None = None) -> Floats:
    ranges = where.distances(place[0], place[1], place[2] + ANGLES, LONGEST)
    return ranges if random is None else ranges + random.normal(0, NOISE, len(ranges))


@given(places, places)
def test_the_step_between_two_places_leads_from_one_to_the_other(start: Place, end: Place) -> None:
    assert errors(after(start, between(start, end)), end) == pytest.approx((0, 0), abs=1e-9)
    assert errors(after(start, inverse(start)), (0, 0, 0)) == pytest.approx((0, 0), abs=1e-9)


def test_ahead_is_where_the_heading_points_and_left_is_counter_clockwise() -> None:
    place = (2.0, 1.0, math.pi / 2)
    assert after(place, (1.0, 0.0, 0.0)) == pytest.approx((2.0, 2.0, math.pi / 2))
    assert moved(np.array([[0.0, 1.0]]), place) == pytest.approx(np.array([[1.0, 1.0]]))
    assert hits(np.array([0.0, math.pi / 2, 1.0]), np.array([2.0, 3.0, np.inf])) == pytest.approx(
        np.array([[2.0, 0.0], [0.0, 3.0]])
    )


def test_rows_are_y_and_columns_are_x() -> None:
    cells = np.zeros((2, 3), np.int8)
    cells[1, 2] = 100
    grid_map = GridMap(cells, 0.5, (-1.0, 4.0))
    assert grid_map.at(np.array([[0.25, 4.75], [-0.9, 4.1], [0.6, 4.1], [0.1, 3.9]])).tolist() == [100, 0, -1, -1]
    assert grid_map.centres(np.array([1]), np.array([2])).tolist() == [[0.25, 4.75]]
    assert grid_map.to_wall[0, 2] == pytest.approx(0.5)
    assert GridMap(cells * 0, 0.5, (0.0, 0.0)).to_wall.min() > 100


def test_what_is_seen_besides_is_a_wall_but_the_walls_that_are_known_do_not_grow() -> None:
    cells = np.zeros((20, 20), np.int8)
    cells[:, 0] = 100
    seen = GridMap(cells, 0.05, (0.0, 0.0)).with_hits(np.array([[0.12, 0.52], [0.62, 0.52], [9.0, 9.0]]))
    assert np.argwhere(seen.cells[:, 1:] == 100).tolist() == [[10, 11]]


def test_a_beam_frees_what_it_passes_and_the_cell_in_which_it_ends_is_a_wall() -> None:
    grid = Grid()
    for _ in range(6):
        grid.add((0.01, 0.01, math.pi / 2), np.array([0.0]), np.array([1.0]), LONGEST)
    grid_map = grid.map()
    along = np.array([[0.01, y] for y in np.arange(0.02, 0.94, 0.05)])
    assert (grid_map.at(along) <= 10).all()
    assert grid_map.at(np.array([[0.01, 1.01]]))[0] >= 90
    beside = np.array([[0.01, 1.11], [0.07, 0.5], [-0.06, 0.5]])
    assert (grid_map.at(beside) == UNKNOWN).all()


def test_an_infinite_range_frees_as_far_as_the_laser_sees_and_one_that_is_none_nothing() -> None:
    grid = Grid()
    grid.add((0.0, 0.0, 0.0), np.array([0.0, math.pi / 2]), np.array([np.inf, np.nan]), 2.0)
    seen = grid.map().at(np.array([[1.9, 0.01], [0.01, 1.0], [2.1, 0.01]]))
    assert 0 <= seen[0] < 50
    assert seen[1:].tolist() == [UNKNOWN, UNKNOWN]


def test_what_goes_away_is_free_again_and_no_cell_is_too_sure_for_that() -> None:
    grid, ahead = Grid(), np.array([0.0])
    for _ in range(1000):
        grid.add((0.0, 0.0, 0.0), ahead, np.array([1.01]), LONGEST)
    for _ in range(30):
        grid.add((0.0, 0.0, 0.0), ahead, np.array([2.01]), LONGEST)
    assert grid.map().at(np.array([[1.01, 0.01]]))[0] < 10


def test_a_map_grows_to_all_sides_and_keeps_what_it_has() -> None:
    grid = Grid()
    for x, y in ((0.0, 0.0), (-7.0, 3.0), (4.0, -6.0)):
        grid.add((x, y, 0.0), np.array([0.0]), np.array([1.01]), LONGEST)
    grid_map = grid.map()
    ends = np.array([[1.01, 0.0], [-5.99, 3.0], [5.01, -6.0]])
    assert (grid_map.at(ends) > 65).all()
    assert (grid_map.cells > 65).sum() == 3


def test_beams_that_end_between_two_cells_stay_on_the_map() -> None:
    grid, ahead, around = Grid(), np.array([0.0]), np.array([0.0, math.pi])
    for count in range(1, 200):  # the map grows with it
        x = 0.05 * count
        Grid().add((x, 0.0, 0.0), ahead, np.array([1.0]), 3.5)
        grid.add((0.0, 0.0, 0.0), around, np.array([x, x]), 99.0)
        for end in (x, -x):
            assert grid.map().at(np.array([[end - 0.01, 0.0], [end + 0.01, 0.0]])).max() > 50


def test_a_map_of_true_places_is_the_true_map() -> None:
    grid, random = Grid(), np.random.default_rng(1)
    for x in np.linspace(-1.0, 1.0, 9):
        place = (x, 0.3 * x, x)
        grid.add(place, ANGLES, scan(ROOM, place, random), LONGEST)
    right, walls = rightness(grid.map(), ROOM)
    assert right > 0.995
    assert walls > 0.97
    # It says something of all that there is to see.
    free = true_map(ROOM)
    rows, columns = np.nonzero(free.to_wall > 0.15)
    inside = free.centres(rows, columns)
    inside = inside[(np.abs(inside[:, 0]) < 1.9) & (np.abs(inside[:, 1]) < 1.4)]
    assert (grid.map().at(inside) != UNKNOWN).mean() > 0.95


def of_places(where: World, *from_where: Place) -> Walls:
    grid, random = Grid(), np.random.default_rng(2)
    for place in from_where:
        grid.add(place, ANGLES, scan(where, place, random), LONGEST)
    return Walls(grid.map(), grid.nearest_walls())


@pytest.mark.parametrize("off", [(0.06, -0.05, 0.05), (-0.08, 0.02, -0.08), (0.0, 0.0, 0.0)])
def test_a_scan_finds_its_place_on_the_map(off: Place) -> None:
    walls = of_places(ROOM, *((0.1 * n, 0.0, 0.2 * n) for n in range(-5, 6)))
    truth = (0.13, 0.11, 0.4)
    found = match(walls, after(truth, off), hits(ANGLES, scan(ROOM, truth, np.random.default_rng(3))))
    metres, radians = errors(found, truth)
    assert metres < 0.03  # of a guess that is twice to three times as far off
    assert radians < 0.015


def test_along_a_corridor_odometry_is_believed_and_across_it_the_scan() -> None:
    walls = of_places(CORRIDOR, *((0.1 * n, 0.0, 0.0) for n in range(-5, 6)))
    truth, guess = (0.0, 0.0, 0.0), (0.06, 0.05, 0.0)
    x, y, _ = match(walls, guess, hits(ANGLES, scan(CORRIDOR, truth, np.random.default_rng(3))))
    assert x == pytest.approx(guess[0], abs=0.01)
    assert y == pytest.approx(truth[1], abs=0.02)


def test_with_too_little_to_see_it_is_the_guess() -> None:
    walls = of_places(ROOM, (0.0, 0.0, 0.0))
    assert match(walls, (0.1, 0.2, 0.3), np.array([[1.0, 0.0]] * 10)) == (0.1, 0.2, 0.3)
    assert match(walls, (90.0, 0.0, 0.0), hits(ANGLES, scan(ROOM, (0.0, 0.0, 0.0)))) == (90.0, 0.0, 0.0)


def round_trip(matching: bool) -> tuple[Slam, Place, Place]:
    """Twice around the room's middle, with odometry that turns 4 % too much: the place in the map and the true one."""
    slam, random = Slam((0.5, -0.9, 0.0), matching=matching), np.random.default_rng(4)
    truth, odometry, found = (0.5, -0.9, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for _ in range(2):
        for turned in [0.0] * 10 + [math.pi / 20] * 10 + [0.0] * 6 + [math.pi / 20] * 10:
            step = (0.0 if turned else 0.04, 0.0, turned)
            truth = after(truth, step)
            odometry = after(odometry, (step[0], 0.0, 1.04 * turned))
            found = slam.update(odometry, ANGLES, scan(ROOM, truth, random), LONGEST)
    return slam, found, truth


def test_matching_keeps_the_place_where_odometry_alone_loses_it() -> None:
    slam, found, truth = round_trip(matching=True)
    metres, radians = errors(found, truth)
    assert metres < 0.05
    assert radians < 0.02
    assert rightness(slam.grid.map(), ROOM)[1] > 0.97
    lost, found, truth = round_trip(matching=False)
    assert errors(found, truth)[1] > 0.2
    assert rightness(lost.grid.map(), ROOM)[1] < 0.9
