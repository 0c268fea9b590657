"""Paths on maps, and how a robot follows one: no ROS, no physics."""

from __future__ import annotations

import heapq
import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from course_kit.robots.navigation import planning
from course_kit.robots.navigation.grid_map import UNKNOWN, GridMap
from course_kit.robots.navigation.journey import FAILED_TO_MAKE_PROGRESS, Journey
from course_kit.robots.navigation.places import Floats, Place, after, wrapped
from course_kit.robots.navigation.planning import CostMap, PlanError, plan, shortest
from course_kit.robots.navigation.pursuit import Limits, Pursuit, room_ahead

SIDE, RADIUS = 0.05, 0.145
LIMITS = Limits()
NOTHING: Floats = np.zeros((0, 2))


def drawn(picture: str, side: float = 0.5) -> GridMap:
    """A map as one sees it, its last line at y = 0: # is a wall, ? unknown; cells of SIDE."""
    says = {"#": 100, "?": UNKNOWN, ".": 0}
    rows = [[says[one] for one in line] for line in reversed(picture.split())]
    times = round(side / SIDE)
    return GridMap(np.kron(np.array(rows), np.ones((times, times), np.int64)).astype(np.int8), SIDE, (0.0, 0.0))


TWO_ROOMS = """
###########
#....#....#
#.........#
#....#....#
#....#....#
###########
"""


def clearances(grid_map: GridMap, path: Floats) -> Floats:
    """From each point of a path to the outside of the nearest wall, m."""
    rows, columns = np.nonzero(grid_map.cells >= 65)
    low = grid_map.centres(rows, columns) - SIDE / 2
    off = np.maximum(np.maximum(low[None] - path[:, None], path[:, None] - low[None] - SIDE), 0.0)
    return np.asarray(np.hypot(off[..., 0], off[..., 1]).min(axis=1))


def test_a_path_leads_through_the_door_in_small_steps_and_touches_no_wall() -> None:
    grid_map = drawn(TWO_ROOMS)
    path = plan(CostMap(grid_map, RADIUS), (1.0, 0.8), (4.7, 0.8))
    assert path[0].tolist() == [1.0, 0.8]
    assert path[-1].tolist() == [4.7, 0.8]
    steps = np.hypot(*np.diff(path, axis=0).T)
    assert steps.max() <= planning.SPACING + 1e-9
    assert (clearances(grid_map, path) > RADIUS - SIDE).all()
    door = path[np.abs(path[:, 0] - 2.75) < 0.2]
    assert np.abs(door[:, 1] - 1.75).max() < 0.06  # in the middle of a door of 0.5 m
    assert planning.length(path) < 1.15 * (math.dist((1.0, 0.8), (2.75, 1.75)) + math.dist((2.75, 1.75), (4.7, 0.8)))


def test_in_the_open_it_is_a_straight_line_whatever_its_direction() -> None:
    grid_map = GridMap(np.zeros((120, 120), np.int8), SIDE, (-3.0, -3.0))
    for angle in np.linspace(0, 2 * math.pi, 15):
        goal = (2.5 * math.cos(angle), 2.5 * math.sin(angle))
        path = plan(CostMap(grid_map, RADIUS), (0.0, 0.0), goal)
        assert planning.length(path) < 2.5 * 1.01


@pytest.mark.parametrize(
    ("start", "goal", "code", "words"),
    [
        ((1.0, 1.0), (9.0, 1.0), planning.GOAL_OUTSIDE_MAP, "goal (9.00, 1.00) is outside"),
        ((-1.0, 1.0), (1.0, 1.0), planning.START_OUTSIDE_MAP, "start (-1.00, 1.00) is outside"),
        ((1.0, 1.0), (2.75, 0.8), planning.GOAL_OCCUPIED, "goal (2.75, 0.80) is in a wall"),
        ((2.75, 0.8), (1.0, 1.0), planning.START_OCCUPIED, "start (2.75, 0.80) is in a wall"),
        ((1.0, 1.0), (2.43, 0.8), planning.GOAL_OCCUPIED, "the robot needs 0.14 m"),
        ((1.0, 1.0), (4.2, 2.2), planning.GOAL_OCCUPIED, "where nothing is known"),
        ((1.0, 1.0), (4.2, 1.0), planning.NO_VALID_PATH, "walls are between them"),
    ],
)
def test_a_goal_that_cannot_be_reached_is_refused_in_one_sentence(
    start: tuple[float, float], goal: tuple[float, float], code: int, words: str
) -> None:
    grid_map = drawn("########### #....#..??# #....#..??# #....#....# #....#....# ###########")
    with pytest.raises(PlanError, match=r"[^\n]+") as refused:
        plan(CostMap(grid_map, RADIUS), start, goal)
    assert (refused.value.code, words in str(refused.value)) == (code, True), str(refused.value)


def test_on_a_map_that_is_not_finished_a_path_may_lead_into_the_unknown_and_beyond_the_edge() -> None:
    grid_map = drawn("###### #....? #....? ######")
    path = plan(CostMap(grid_map, RADIUS, into_unknown=True), (1.0, 1.0), (6.0, 1.0))
    assert path[-1].tolist() == [6.0, 1.0]
    with pytest.raises(PlanError):
        plan(CostMap(grid_map, RADIUS), (1.0, 1.0), (6.0, 1.0))


def test_a_robot_too_near_to_a_wall_may_leave_it_but_not_through_it() -> None:
    path = plan(CostMap(drawn(TWO_ROOMS), RADIUS), (2.42, 0.8), (4.0, 0.8))
    assert (clearances(drawn(TWO_ROOMS), path) > 0.02).all()


def cheapest(costs: Floats, start: tuple[int, int], goal: tuple[int, int]) -> float:
    """What the cheapest way costs, by Dijkstra: slow and simple."""
    best, waiting = {start: 0.0}, [(0.0, start)]
    while waiting:
        spent, (row, column) = heapq.heappop(waiting)
        for up, right in ((1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)):
            there = row + up, column + right
            if 0 <= there[0] < costs.shape[0] and 0 <= there[1] < costs.shape[1]:
                total = spent + math.hypot(up, right) * (costs[row, column] + costs[there]) / 2
                if total < best.get(there, math.inf):
                    best[there] = total
                    heapq.heappush(waiting, (total, there))
    return best.get(goal, math.inf)


@settings(deadline=None, max_examples=50)
@given(st.integers(0, 10_000))
def test_no_way_is_cheaper_than_the_one_of_a_star(seed: int) -> None:
    random = np.random.default_rng(seed)
    costs = 1 + 5 * random.random((9, 12))
    costs[random.random((9, 12)) < 0.35] = np.inf
    costs[0, 0] = costs[8, 11] = 1.0
    way = shortest(costs, (0, 0), (8, 11))
    best = cheapest(costs, (0, 0), (8, 11))
    if way is None:
        assert best == math.inf
        return
    assert (way[0], way[-1]) == ((0, 0), (8, 11))
    spent = sum(math.dist(a, b) * (costs[a] + costs[b]) / 2 for a, b in pairwise(way))
    assert spent == pytest.approx(best)


def drive(journey: Journey, place: Place, seconds: float, points: Floats = NOTHING) -> tuple[Place, list[Place], float]:
    """A robot that drives as it is told: where it ends, where it was, how long it took."""
    was, time = [place], 0.0
    while journey.end is None and time < seconds:
        seen = np.column_stack([*(points - place[:2]).T])
        cosine, sine = math.cos(place[2]), math.sin(place[2])
        seen = seen @ np.array([[cosine, -sine], [sine, cosine]])
        speed, turning = journey.tick(time, place, seen)
        assert 0 <= speed <= LIMITS.speed + 1e-9
        assert abs(turning) <= LIMITS.turning + 1e-9
        place = after(place, (speed * 0.1, 0.0, turning * 0.1))
        was.append(place)
        time += 0.1
    return place, was, time


CURVE = np.array([(x, 0.5 * math.sin(2 * x)) for x in np.arange(0.0, 3.0, 0.04)])


@pytest.mark.parametrize("heading", [0.0, math.pi, -2.0])
def test_it_follows_a_curve_and_arrives_with_the_heading_of_the_goal(heading: float) -> None:
    journey = Journey((*CURVE[-1], 1.0), LIMITS)
    assert journey.wants_path(0.0)
    journey.follow(CURVE)
    place, was, seconds = drive(journey, (0.0, 0.0, heading), 60.0)
    assert journey.end is not None
    assert journey.end.arrived
    assert math.dist(place[:2], CURVE[-1]) < 0.06
    assert abs(wrapped(place[2] - 1.0)) < 0.06
    off = [np.hypot(*(CURVE - one[:2]).T).min() for one in was]
    assert max(off) < 0.08  # a chord of 0.25 m cuts that much of a curve with a radius of 0.5 m
    assert seconds < 3 * planning.length(CURVE) / LIMITS.speed


def test_the_metres_that_are_left_are_right_after_a_long_tick_too() -> None:
    """A busy machine's; the last brings the robot to the goal, where it only has to turn."""
    path = np.column_stack([np.linspace(2, 3, 21), np.zeros(21)])
    journey = Journey((3.0, 0.0, 1.0), LIMITS)
    journey.follow(path)
    for time, x in ((0.0, 2.2), (3.0, 2.86), (3.5, 2.97)):
        journey.tick(time, (x, 0.0, 0.0), NOTHING)
        assert journey.remaining((x, 0.0, 0.0)) == pytest.approx(3.0 - x, abs=0.05)


def test_the_circle_to_a_point_leads_there() -> None:
    pursuit = Pursuit(np.array([[0.0, 0.0], [0.25, 0.1], [0.5, 0.4]]), Limits(ahead=0.2))
    speed, turning = pursuit.command((0.0, 0.0, 0.0), math.inf, math.inf)
    radius = speed / turning
    assert math.dist((0.25, 0.1), (0.0, radius)) == pytest.approx(radius)


def test_where_something_is_in_the_way_to_a_point_far_ahead_it_turns_to_the_next_ones() -> None:
    path = np.array([(0.0, 0.0), (0.045, 0.025), (0.09, 0.04), (0.14, 0.04), (0.2, 0.02), (0.25, 0.0), (0.3, -0.03)])
    pursuit = Pursuit(path, LIMITS)
    _, straight_on = pursuit.command((0.0, 0.0, 0.0), math.inf, math.inf)
    assert abs(straight_on) < 0.1
    speed, turning = pursuit.command((0.0, 0.0, 0.0), LIMITS.stop / 2, 0.11)
    assert speed == 0
    assert turning > 0.5


def test_it_stops_before_what_the_laser_sees_then_wants_another_path_and_in_the_end_gives_up() -> None:
    path = np.column_stack([np.linspace(0, 3, 60), np.zeros(60)])
    pillar = np.array([(1.5 + 0.1 * math.cos(a), 0.1 * math.sin(a)) for a in np.linspace(0, 2 * math.pi, 40)])
    journey = Journey((3.0, 0.0, 0.0), LIMITS)
    journey.follow(path)
    place, _, _ = drive(journey, (0.0, 0.0, 0.0), 12.0, pillar)
    assert place[0] == pytest.approx(1.4 - LIMITS.radius - LIMITS.stop, abs=0.02)
    assert journey.end is None
    assert journey.wants_path(12.0)
    drive(journey, place, 20.0, pillar)
    assert journey.end is None  # it waits for the path
    journey.refuse()
    drive(journey, place, 20.0, pillar)
    assert journey.end is not None
    assert (journey.end.arrived, journey.end.code) == (False, FAILED_TO_MAKE_PROGRESS)


def test_seconds_in_which_it_was_told_nothing_do_not_hold_it() -> None:
    journey = Journey((3.0, 0.0, 0.0), LIMITS)
    journey.follow(np.column_stack([np.linspace(0, 3, 60), np.zeros(60)]))
    for time in (0.0, 0.1, 30.0, 30.1, 60.0):  # tf or the laser were missing for long
        journey.tick(time, (0.0, 0.0, 0.0), np.zeros((0, 2)))
    assert journey.end is None


def test_a_path_that_a_newer_map_closes_is_given_up_and_no_other_is_wanted_before() -> None:
    grid_map = drawn(TWO_ROOMS)
    journey = Journey((4.7, 0.8, 0.0), LIMITS)
    journey.follow(plan(CostMap(grid_map, RADIUS), (1.0, 0.8), (4.7, 0.8)))
    journey.check(CostMap(grid_map, RADIUS), (1.0, 0.8, 0.0))
    assert not journey.wants_path(1.0)
    closed = grid_map.with_hits(np.array([[2.75, y] for y in np.arange(1.5, 2.0, 0.04)]))
    closed.cells[30:40, 50:60] = 100
    journey.check(CostMap(closed, RADIUS), (1.0, 0.8, 0.0))
    assert [journey.wants_path(time) for time in (2.0, 2.1, 5.0)] == [True, False, True]


def test_room_is_what_a_round_robot_can_drive() -> None:
    radius = LIMITS.radius
    assert room_ahead(np.array([[0.5, 0.0]]), LIMITS) == pytest.approx(0.5 - radius)
    assert room_ahead(np.array([[0.5, 0.5], [-0.3, 0.0]]), LIMITS) == math.inf
    aside = room_ahead(np.array([[0.5, 0.08]]), LIMITS)
    assert aside == pytest.approx(0.5 - math.sqrt(radius**2 - 0.08**2))
