"""The worlds of chapter 7's exam: in each the goal is behind walls of which nobody knows at the start."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from random import Random
from typing import TYPE_CHECKING

import numpy as np

from course_kit.examining.vocabulary_robot import a_way
from course_kit.robot.shape import LASER, LONGEST, RADIUS, RAYS
from course_kit.robot.world import World
from course_kit.robot.worlds import NAMES, world

if TYPE_CHECKING:
    from course_kit.navigation.grid_map import GridMap

Point = tuple[float, float]
SHORTEST, FARTHEST = 2.0, 6.0  # metres of way to a goal
MARGINS = (0.0, 0.02, 0.04, 0.06)  # metres that a plan may keep from walls besides the robot's radius
AROUND = 0.2  # metres from the end of a wall within which a plan through it may come out beside it
BY_HEART = 0.5  # metres, seen from the start, from a goal of the worlds that everybody knows


@dataclass(frozen=True)
class Task:
    """A world, the place in it to go to, and the metres of the shortest way there."""

    world: World
    goal: Point
    way: float


def draw(kind: str, chance: Random) -> Task:
    """A task in a world of this kind that no one passes by luck.

    Neither as the crow flies nor by a plan made at the start can the robot get there, nor is the goal, seen from the
    start, where one of the worlds without a seed has one.
    """
    while True:
        where = world(kind, chance.randrange(1_000, 1_000_000))
        for goal in chance.sample(where.goals, len(where.goals)):
            if math.dist(where.start[:2], goal) > FARTHEST or _is_known(where, goal) or _is_straight(where, goal):
                continue
            way = _length(a_way(where, where.start[:2], goal))
            if SHORTEST < way < FARTHEST and _is_hidden(where, goal):
                return Task(where, goal, way)


def _is_known(where: World, goal: Point) -> bool:
    from course_kit.navigation.places import between

    known = [(one.start, place) for one in map(world, NAMES) for place in one.goals]
    seen = between(where.start, (*goal, 0.0))[:2]
    return any(math.dist(seen, between(start, (*place, 0.0))[:2]) < BY_HEART for start, place in known)


def _is_straight(where: World, goal: Point) -> bool:
    """Whether nothing is between start and goal."""
    straight = np.linspace(where.start[:2], goal, 200)
    return bool(where.clearances(*straight.T).min() > 0)


def _is_hidden(where: World, goal: Point) -> bool:
    """Whether a plan made at the start leads through the midst of a wall, whatever it keeps from walls."""
    from course_kit.navigation.places import between, moved
    from course_kit.navigation.planning import CostMap, plan

    walls = [replace(one, length=one.length - 2 * AROUND) for one in where.walls if one.length > 2 * AROUND]
    midst = replace(where, walls=tuple(walls), pillars=())
    seen, there = _first_map(where), between(where.start, (*goal, 0.0))[:2]
    plans = (plan(CostMap(seen, RADIUS + margin, into_unknown=True), (0.0, 0.0), there) for margin in MARGINS)
    return all(midst.clearances(*moved(first, where.start).T).min() < 0 for first in plans)


def _first_map(where: World) -> GridMap:
    """The map that a scan at the start gives, which is its origin: its cells are turned as the robot is."""
    from course_kit.navigation.grid import Grid
    from course_kit.navigation.places import after

    grid, angles, laser = Grid(), np.arange(RAYS, dtype=np.float64) * (math.tau / RAYS), (LASER[0], LASER[1], 0.0)
    x, y, heading = after(where.start, laser)
    grid.add(laser, angles, where.distances(x, y, angles + heading), LONGEST)
    return grid.map()


def _length(way: list[Point]) -> float:
    return sum(math.dist(a, b) for a, b in pairwise(way))
