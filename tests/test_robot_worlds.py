"""The robot's worlds: what they measure, from files and seeds; a robot gets from each place to each other."""

from __future__ import annotations

import math
import subprocess
import sys
from collections import deque

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from course_kit.robots.robot.shape import LONGEST, RADIUS
from course_kit.robots.robot.world import Pillar, Wall, World
from course_kit.robots.robot.worlds import NAMES, world

SEEDS = (1, 2, 3, 20, 58)
START = (0.0, 0.0, 0.0)
EAST, NORTH, WEST, SOUTH = np.arange(4) * math.pi / 2


def of(*things: Wall | Pillar) -> World:
    walls = tuple(one for one in things if isinstance(one, Wall))
    pillars = tuple(one for one in things if isinstance(one, Pillar))
    return World("of the test", walls, pillars, START, ())


# Distances, by hand


def test_distances_to_a_wall_are_those_to_its_sides() -> None:
    wall = of(Wall(2.0, 0.0, 1.0, 0.2))  # from 1.5 to 2.5, and 0.1 to both sides
    assert wall.distances(0, 0, [EAST, NORTH, WEST]) == pytest.approx([1.5, math.inf, math.inf])
    assert wall.distances([2.0, 2.0, 2.0], [1.0, -1.0, -1.0], [SOUTH, NORTH, SOUTH]) == pytest.approx(
        [0.9, 0.9, math.inf]
    )
    assert wall.distances(0, 0.1 - 1e-9, EAST) == pytest.approx(1.5)
    assert wall.distances(0, 0.1 + 1e-9, EAST) == math.inf


def test_distances_to_a_turned_wall() -> None:
    wall = of(Wall(1.0, 0.0, 2.0, 0.2, math.pi / 4))
    # Its middle line goes through (1, 0) at 45 degrees; its side is 0.1 m nearer, measured square to it.
    assert wall.distances(0, 0, EAST) == pytest.approx(1.0 - 0.1 * math.sqrt(2))
    assert wall.distances(0, 0, -math.pi / 4) == pytest.approx(math.sqrt(0.5) - 0.1)


def test_distances_to_a_pillar() -> None:
    pillar = of(Pillar(3.0, 0.0, 0.5))
    edge = math.asin(0.5 / 3.0)
    assert pillar.distances(0, 0, [EAST, WEST, NORTH]) == pytest.approx([2.5, math.inf, math.inf])
    assert pillar.distances(0, 0, edge - 1e-9) == pytest.approx(math.sqrt(9 - 0.25), abs=1e-3)
    assert pillar.distances(0, 0, edge + 1e-6) == math.inf


def test_the_nearest_counts_and_nothing_beyond_reach() -> None:
    two = of(Wall(2.0, 0.0, 0.2, 1.0), Pillar(1.0, 0.0, 0.1), Wall(-3.6, 0.0, 0.1, 1.0))
    assert two.distances(0, 0, EAST) == pytest.approx(0.9)
    assert two.distances(0, 0, WEST) == math.inf  # at 3.55 m
    assert LONGEST == 3.5
    assert two.distances(0, 0, WEST, longest=4.0) == pytest.approx(3.55)


def test_distances_from_inside_are_0() -> None:
    both = of(Wall(0.0, 0.0, 1.0, 1.0), Pillar(5.0, 0.0, 1.0))
    assert both.distances([0.1, 5.2], 0.1, 1.0).tolist() == [0.0, 0.0]


def test_distances_take_arrays_that_broadcast() -> None:
    angles = np.linspace(0, math.tau, 7)
    found = world("rooms").distances(np.array([1.0, 2.0])[:, None], np.array([1.0, 1.5])[:, None], angles)
    assert found.shape == (2, 7)
    assert found[1].tolist() == world("rooms").distances(2.0, 1.5, angles).tolist()


def test_clearance_by_hand() -> None:
    both = of(Wall(2.0, 0.0, 1.0, 0.2), Pillar(0.0, 3.0, 0.5))
    assert both.clearance(1.0, 0.0) == pytest.approx(0.5)
    assert both.clearance(2.0, 1.0) == pytest.approx(0.9)
    assert both.clearance(2.5 + 0.3, 0.1 + 0.4) == pytest.approx(0.5)  # to a corner
    assert both.clearance(2.0, 0.02) == pytest.approx(-0.08)
    assert both.clearance(0.0, 2.8) == pytest.approx(-0.3)


@settings(deadline=None)
@given(x=st.floats(0.1, 7.9), y=st.floats(0.1, 5.9))
def test_clearance_is_the_shortest_distance(x: float, y: float) -> None:
    rooms = world("rooms")
    nearest = rooms.distances(x, y, np.linspace(0, math.tau, 3600), longest=10.0).min()
    clear = rooms.clearance(x, y)
    # The nearest of rays 0.1 degrees apart is a little longer, most before a corner that lies between two.
    assert nearest < 1e-9 if clear <= 0 else clear - 1e-9 <= nearest <= clear + 0.01


def test_bounds_hold_what_is_turned() -> None:
    assert of(Wall(0.0, 0.0, 2.0, 0.0, math.pi / 6), Pillar(3.0, 0.0, 0.5)).bounds() == pytest.approx(
        (-math.sqrt(0.75), -0.5, 3.5, 0.5)
    )
    assert world("rooms").bounds() == (-0.05, -0.05, 8.05, 6.05)


# The true map


def test_occupancy_has_row_0_below_and_its_corner_at_the_bounds() -> None:
    cells, corner = of(Wall(1.0, 0.5, 2.0, 1.0), Pillar(1.75, 2.0, 0.2)).occupancy(0.25)
    assert corner == (0.0, 0.0)
    assert cells.dtype == np.int8
    assert cells.shape == (9, 8)
    assert (cells[:4] == 100).all()
    assert (cells[4:6] == 0).all()
    assert np.argwhere(cells[6:] == 100).tolist() == [[1, 6], [1, 7], [2, 6], [2, 7]] or (cells[7, 6:] == 100).all()


@pytest.mark.parametrize("name", NAMES)
def test_occupancy_is_the_world(name: str) -> None:
    one = world(name)
    cells, (left, bottom) = one.occupancy()
    rows, columns = np.indices(cells.shape)
    clear = one.clearances(left + (columns + 0.5) * 0.05, bottom + (rows + 0.5) * 0.05)
    assert (cells[clear <= 0] == 100).all()
    assert (cells[clear > 0.0126] == 0).all()
    x0, y0, x1, y1 = one.bounds()
    assert left <= x0 < left + 0.05
    assert bottom <= y0 < bottom + 0.05
    assert left + cells.shape[1] * 0.05 >= x1 - 1e-9
    assert bottom + cells.shape[0] * 0.05 >= y1 - 1e-9


# Files and seeds


def reachable(one: World) -> tuple[set[tuple[int, int]], int]:
    """The cells of 0.05 m that a robot with 0.1 m to spare reaches from the start, and how many it has room in."""
    x0, y0, x1, y1 = one.bounds()
    columns, rows = round((x1 - x0) / 0.05), round((y1 - y0) / 0.05)
    x, y = x0 + (np.arange(columns) + 0.5) * 0.05, y0 + (np.arange(rows) + 0.5) * 0.05
    # Clearances beside most walls come in steps of 0.005 m: the bound lies between two.
    room = one.clearances(x[:, None], y[None, :]) >= RADIUS + 0.0975
    start = (int((one.start[0] - x0) / 0.05), int((one.start[1] - y0) / 0.05))
    seen, front = {start}, deque([start])
    while front:
        column, row = front.popleft()
        for there in ((column + 1, row), (column - 1, row), (column, row + 1), (column, row - 1)):
            if there not in seen and 0 <= there[0] < columns and 0 <= there[1] < rows and room[there]:
                seen.add(there)
                front.append(there)
    return seen, int(room.sum())


@pytest.mark.parametrize("seed", [None, *SEEDS])
@pytest.mark.parametrize("name", NAMES)
def test_a_robot_gets_from_the_start_to_everywhere(name: str, seed: int | None) -> None:
    one = world(name, seed)
    seen, cells = reachable(one)
    assert len(seen) == cells > 1000
    x0, y0, _, _ = one.bounds()
    assert len(set(one.goals)) == len(one.goals) == 3
    for x, y in (one.start[:2], *one.goals):
        assert (int((x - x0) / 0.05), int((y - y0) / 0.05)) in seen
        assert one.clearance(x, y) > RADIUS + 0.15
    assert all(math.dist(one.start[:2], goal) > 0.9 for goal in one.goals)


@pytest.mark.parametrize("name", NAMES)
def test_a_seed_gives_one_world(name: str) -> None:
    one = world(name, 7)
    assert one == world(name, 7)
    assert (one.name, one.seed) == (name, 7)
    assert len({one, world(name, 8), world(name), world(name, -7)}) == 4


def test_a_seed_gives_the_same_world_in_another_process() -> None:
    code = "from course_kit import world; print(world('office', 5))"
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True).stdout
    assert said.strip() == str(world("office", 5))


@pytest.mark.parametrize(
    ("name", "seed", "says"),
    [
        ("house", None, "There is no world 'house'; there are empty, rooms, maze, office. Write it like"),
        ("rooms", 1.5, "seed must be a whole number, not 1.5. Write it like world('rooms', seed=3)"),
        ("maze", True, "seed must be a whole number, not True."),
        ("../rooms", 1, "There is no world '../rooms'"),
    ],
)
def test_other_worlds_are_refused_in_a_line(name: str, seed: int | None, says: str) -> None:
    with pytest.raises(ValueError) as refused:
        world(name, seed)
    assert "\n" not in str(refused.value)
    assert str(refused.value).startswith(says)


def test_importing_the_worlds_loads_nothing_heavy() -> None:
    code = "import sys, course_kit.robots.robot.worlds; sys.exit(bool({'rclpy', 'mujoco', 'scipy'} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", code], timeout=60).returncode == 0
