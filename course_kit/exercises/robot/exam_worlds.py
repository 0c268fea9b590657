"""The worlds of the exam: in each, walls that no map shows stand before the goal."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import product
from random import Random
from typing import TYPE_CHECKING

import numpy as np

from course_kit.exercises.checker.robot_fixtures import a_way
from course_kit.robots.robot.shape import LASER, LONGEST, RADIUS, RAYS
from course_kit.robots.robot.world import World
from course_kit.robots.robot.worlds import NAMES, world

if TYPE_CHECKING:
    from course_kit.robots.navigation.grid import Grid
    from course_kit.robots.navigation.grid_map import GridMap
    from course_kit.robots.navigation.places import Floats
    from course_kit.robots.navigation.planning import CostMap

Point = tuple[float, float]
Planner = tuple[float, float]
ANGLES = np.arange(RAYS, dtype=np.float64) * (math.tau / RAYS)  # of the laser's beams
SHORTEST, FARTHEST = 2.0, 6.0  # metres of way to a goal
# Planners of students: metres that they keep from walls besides the robot's radius, and what an unknown cell costs.
PLANNERS = tuple(product((0.0, 0.02, 0.04, 0.06), (0.0, 1.5, 5.0)))
AROUND = 0.2  # metres from the end of a wall within which a plan through it may come out beside it
DETOUR = 2.0  # times the shortest way that a robot drives, at most, which plans anew when a wall appears on its path
LOOK = 5  # points of a path, 0.25 m, from look to look of such a robot
BY_HEART = 0.5  # metres, seen from the start, from a goal of the worlds that everybody knows


@dataclass(frozen=True)
class Task:
    """A world, the place in it to go to, and the metres of the shortest way there."""

    world: World
    goal: Point
    way: float


def draw(kind: str, chance: Random) -> Task:
    """A task in a world of this kind that no one passes by luck, and no one fails by it.

    Neither as the crow flies nor by a plan made at the start can the robot get there, nor is the goal, seen from the
    start, where one of the worlds without a seed has one. Each planner comes there in time by planning anew.
    """
    from course_kit.robots.navigation.planning import PlanError, length

    while True:
        where = world(kind, chance.randrange(1_000, 1_000_000))
        for goal in chance.sample(where.goals, len(where.goals)):
            if math.dist(where.start[:2], goal) > FARTHEST or _is_known(where, goal) or _is_straight(where, goal):
                continue
            way = length(np.array(a_way(where, where.start[:2], goal)))
            try:
                if SHORTEST < way < FARTHEST and _is_hidden(where, goal) and _is_fair(where, goal, way):
                    return Task(where, goal, way)
            except PlanError:  # one of the planners gets into a wall that it sees too late
                continue


def _is_known(where: World, goal: Point) -> bool:
    from course_kit.robots.navigation.places import between

    known = [(one.start, place) for one in map(world, NAMES) for place in one.goals]
    seen = between(where.start, (*goal, 0.0))[:2]
    return any(math.dist(seen, between(start, (*place, 0.0))[:2]) < BY_HEART for start, place in known)


def _is_straight(where: World, goal: Point) -> bool:
    """Return True if nothing is between start and goal."""
    straight = np.linspace(where.start[:2], goal, 200)
    return bool(where.clearances(*straight.T).min() > 0)


def _is_hidden(where: World, goal: Point) -> bool:
    """Return True if a plan made at the start leads through the midst of a wall, whoever makes it."""
    from course_kit.robots.navigation.places import moved

    walls = [replace(one, length=one.length - 2 * AROUND) for one in where.walls if one.length > 2 * AROUND]
    midst = replace(where, walls=tuple(walls), pillars=())
    plans = (_first_plan(where, goal, planner) for planner in PLANNERS)
    return all(midst.clearances(*moved(first, where.start).T).min() < 0 for first in plans)


def _is_fair(where: World, goal: Point, way: float) -> bool:
    """Return True if a robot that plans anew at each new wall has no long detour in this world."""
    return all(_found_way(where, goal, planner, DETOUR * way) <= DETOUR * way for planner in PLANNERS)


def _found_way(where: World, goal: Point, planner: Planner, enough: float) -> float:
    """Metres to a goal for a robot that plans on what it has seen, and anew when that is in the way.

    Where they are more than `enough`, they are not all of them.
    """
    from course_kit.robots.navigation.grid import Grid
    from course_kit.robots.navigation.places import between
    from course_kit.robots.navigation.planning import length, plan

    grid, there = Grid(), between(where.start, (*goal, 0.0))[:2]
    path = _first_plan(where, goal, planner)
    metres = 0.0
    while metres <= enough:
        here = (float(path[0, 0]), float(path[0, 1]))
        _see(grid, where, here)
        costs = _costs(grid.map(), planner)
        if not costs.is_free(path[np.hypot(*(path - here).T) > RADIUS]).all():
            path = plan(costs, here, there)
        metres += length(path[: LOOK + 1])
        if len(path) <= LOOK + 1:
            return metres
        path = path[LOOK:]
    return metres


@lru_cache(len(PLANNERS))
def _first_plan(where: World, goal: Point, planner: Planner) -> Floats:
    """Points of the path, seen from the start, that a planner makes there."""
    from course_kit.robots.navigation.grid import Grid
    from course_kit.robots.navigation.places import between
    from course_kit.robots.navigation.planning import plan

    grid = Grid()
    _see(grid, where, (0.0, 0.0))
    return plan(_costs(grid.map(), planner), (0.0, 0.0), between(where.start, (*goal, 0.0))[:2])


def _see(grid: Grid, where: World, point: Point) -> None:
    """Add a scan to a map, made at a point of it; the start is its origin, so its cells are turned as the robot is."""
    from course_kit.robots.navigation.places import after

    place = after((*point, 0.0), (LASER[0], LASER[1], 0.0))
    x, y, heading = after(where.start, place)
    grid.add(place, ANGLES, where.distances(x, y, ANGLES + heading), LONGEST)


def _costs(seen: GridMap, planner: Planner) -> CostMap:
    from course_kit.robots.navigation.planning import CostMap

    margin, unknown_cost = planner
    return CostMap(seen, RADIUS + margin, into_unknown=True, unknown_cost=unknown_cost)
