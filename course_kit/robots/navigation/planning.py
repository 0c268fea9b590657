"""A path from here to there that keeps away from walls: A* on the cells of a map.

An example to read. Walls grow by the robot's radius, so that it may be planned for as a point; near them a cell costs
more, so that the path keeps to the middle. A* looks at the cell first from which start to goal would be shortest. The
steps of a path over cells are then smoothed. No ROS: the node is Planner.
"""

from __future__ import annotations

import heapq
import math
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from course_kit.robots.navigation.grid_map import OCCUPIED, UNKNOWN, GridMap
from course_kit.robots.navigation.places import Floats

# Error codes as those of Nav2's planners.
START_OUTSIDE_MAP, GOAL_OUTSIDE_MAP, START_OCCUPIED, GOAL_OCCUPIED, NO_VALID_PATH = 203, 204, 205, 206, 208
WALL_COST, WALL_REACH = 8.0, 0.12  # what a cell at the edge of a grown wall costs besides, and metres until a third
UNKNOWN_COST = 1.5  # besides, where nothing is known
ESCAPE = 0.25  # metres around the start in which the robot may be nearer to a wall than it should
TIGHT = 30.0  # what a cell costs there
EDGE = 1.0  # metres of unknown cells around what a path into the unknown may need
SPACING = 0.05  # metres from point to point of a path
LOOK = 4  # points: where a straight line may end is looked at in such steps
STRAIGHT = math.sqrt(2) - 1


class PlanError(ValueError):
    """There is no path: why, in one sentence, and Nav2's code for it."""

    def __init__(self, code: int, why: str) -> None:
        super().__init__(why)
        self.code = code


@dataclass(frozen=True, eq=False)
class CostMap:
    """What it costs to drive over each cell of a map: 1 far from walls, more near them, infinite nearer than `radius`.

    Into the unknown a path may lead if `into_unknown`: of a map that is still being made; a cell there costs
    `unknown_cost` besides.
    """

    map: GridMap
    radius: float  # metres from the robot's middle to all walls, at least
    into_unknown: bool = False
    unknown_cost: float = UNKNOWN_COST

    @cached_property
    def costs(self) -> Floats:
        """Of each cell, shape (height, width)."""
        near = np.maximum(self.map.to_wall - self.radius, 0.0)
        costs = 1 + WALL_COST * np.exp(-near / WALL_REACH)
        costs[self.map.cells == UNKNOWN] += self.unknown_cost if self.into_unknown else np.inf
        costs[self.map.to_wall < self.radius] = np.inf
        return costs

    def is_free(self, points: Floats) -> npt.NDArray[np.bool_]:
        """At which points, shape (n, 2), the robot may be; outside of the map as in the unknown."""
        rows, columns = self.map.cells_of(points)
        inside = self.map.inside(rows, columns)
        free = np.full(len(points), self.into_unknown)
        free[inside] = np.isfinite(self.costs[rows[inside], columns[inside]])
        return free

    def reaching(self, points: Floats) -> CostMap:
        """The same with unknown cells added around, so that a way around what stands at its edge is on it too."""
        size, side = np.array(self.map.cells.shape)[::-1], self.map.resolution
        low = np.floor((np.vstack([points, [self.map.origin]]).min(axis=0) - EDGE - self.map.origin) / side).astype(int)
        high = np.ceil((points.max(axis=0) + EDGE - self.map.origin) / side).astype(int)
        (left, below), (right, above) = -low, np.maximum(high - size, round(EDGE / side))
        cells = np.pad(self.map.cells, ((below, above), (left, right)), constant_values=UNKNOWN)
        origin = (self.map.origin[0] - left * side, self.map.origin[1] - below * side)
        return replace(self, map=GridMap(cells, side, origin))


def plan(cost_map: CostMap, start: tuple[float, float], goal: tuple[float, float]) -> Floats:
    """Points of a path in metres, shape (n, 2), some SPACING from each other; raises PlanError where there is none."""
    if cost_map.into_unknown:
        cost_map = cost_map.reaching(np.array([start, goal]))
    here, there = _cell(cost_map.map, start), _cell(cost_map.map, goal)
    refuse(cost_map, start, goal)
    costs = _with_escape(cost_map, start)
    cells = shortest(costs, here, there)
    if cells is None:
        raise PlanError(NO_VALID_PATH, f"no way leads from {_at(start)} to {_at(goal)}: walls are between them")
    rows, columns = np.array(cells).T
    points = cost_map.map.centres(rows, columns)
    points[0], points[-1] = start, goal
    points = spaced(straightened(points, cost_map.map, costs), SPACING)
    return spaced(smooth(points, cost_map), SPACING)


def refuse(cost_map: CostMap, start: tuple[float, float], goal: tuple[float, float]) -> None:
    """Raise PlanError for a start or a goal, x and y in m, at which the robot cannot be."""
    grid_map = cost_map.map
    for what, point, outside, occupied in (
        ("start", start, START_OUTSIDE_MAP, START_OCCUPIED),
        ("goal", goal, GOAL_OUTSIDE_MAP, GOAL_OCCUPIED),
    ):
        points = np.array([point])
        if not grid_map.inside(*grid_map.cells_of(points))[0]:
            raise PlanError(outside, f"the {what} {_at(point)} is outside of the map")
        if grid_map.at(points)[0] >= OCCUPIED:
            raise PlanError(occupied, f"the {what} {_at(point)} is in a wall")
        if what == "goal" and not cost_map.is_free(points)[0]:
            wall = float(grid_map.wall_distances(points)[0])
            why = f"{wall:.2f} m from a wall, the robot needs {cost_map.radius:.2f} m"
            unknown = "where nothing is known yet"
            raise PlanError(occupied, f"the goal {_at(point)} is {why if wall < cost_map.radius else unknown}")


def _with_escape(cost_map: CostMap, start: tuple[float, float]) -> Floats:
    """The costs, but a robot that is too near to a wall may leave."""
    grid_map = cost_map.map
    costs = cost_map.costs.copy()
    rows, columns = np.nonzero(np.isinf(costs) & (grid_map.cells < OCCUPIED))
    near = np.hypot(*(grid_map.centres(rows, columns) - np.array(start)).T) < ESCAPE
    costs[rows[near], columns[near]] = TIGHT
    return costs


def shortest(costs: Floats, start: tuple[int, int], goal: tuple[int, int]) -> list[tuple[int, int]] | None:
    """The cheapest way from cell to cell (row, column), both included, by A*; None if there is none.

    A step costs its length times the mean of both cells' costs; none is below 1, so the way as the crow flies is never
    too long a guess of what is left.
    """
    # A border of infinite cells in one list: a neighbour is a number away, and none is outside.
    cost = np.pad(costs, 1, constant_values=np.inf)
    rows, columns = (np.abs(np.arange(size) - (place + 1)) for size, place in zip(cost.shape, goal, strict=True))
    most, least = np.maximum.outer(rows, columns), np.minimum.outer(rows, columns)
    left = (most + STRAIGHT * least).ravel().tolist()  # of each cell, as the crow flies
    width = cost.shape[1]
    each = cost.ravel().tolist()
    first, last = ((row + 1) * width + column + 1 for row, column in (start, goal))
    ways = [(1, 0.5), (-1, 0.5), (width, 0.5), (-width, 0.5)]  # half the length of a step
    ways += [(up + side, math.sqrt(2) / 2) for up in (width, -width) for side in (1, -1)]
    spent, before, done = [math.inf] * len(each), {first: first}, bytearray(len(each))
    spent[first] = 0.0
    waiting = [(0.0, first)]
    while waiting:
        _, cell = heapq.heappop(waiting)
        if cell == last:
            break
        if done[cell]:
            continue
        done[cell] = True
        so_far, here = spent[cell], each[cell]
        for way, half in ways:
            there = cell + way
            total = so_far + half * (here + each[there])
            if total < spent[there]:
                spent[there], before[there] = total, cell
                heapq.heappush(waiting, (total + left[there], there))
    else:
        return None
    cells = [last]
    while cells[-1] != first:
        cells.append(before[cells[-1]])
    return [(cell // width - 1, cell % width - 1) for cell in reversed(cells)]


def straightened(points: Floats, grid_map: GridMap, costs: Floats) -> Floats:
    """Corners of the same path: over cells it has eight directions, a straight line often costs less."""
    spent = np.concatenate([[0.0], np.cumsum(_costs_of_lines(grid_map, costs, points[:-1], points[1:]))])
    corners, last = [0], len(points) - 1
    while (here := corners[-1]) < last:
        further = np.arange(last, here + 1, -LOOK)
        straight = _costs_of_lines(grid_map, costs, points[here], points[further])
        costs_less = further[straight <= spent[further] - spent[here]]
        corners.append(int(costs_less[0]) if len(costs_less) else here + 1)
    return points[corners]


def _costs_of_lines(grid_map: GridMap, costs: Floats, starts: Floats, ends: Floats) -> Floats:
    """The costs of straight lines, shape (n,): from a start each, or all from one, to ends of shape (n, 2)."""
    ways = ends - starts
    metres = np.hypot(*ways.T)
    along = np.linspace(0.0, 1.0, 2 + math.ceil(metres.max(initial=0.0) / (grid_map.resolution / 2)))
    lines = np.atleast_2d(starts)[:, None] + along[:, None] * ways[:, None]
    rows, columns = grid_map.cells_of(lines.reshape(-1, 2))
    return np.asarray(costs[rows, columns].reshape(len(ends), len(along)).mean(axis=1) * metres)


def smooth(points: Floats, cost_map: CostMap, rounds: int = 60) -> Floats:
    """The same path without the corners of its cells: each point moves between its neighbours, but not into a wall."""
    result = points.copy()
    for _ in range(rounds):
        between = (result[:-2] + result[2:]) / 2
        wanted = result[1:-1] + 0.5 * (between - result[1:-1]) + 0.1 * (points[1:-1] - result[1:-1])
        free = cost_map.is_free(wanted)
        result[1:-1][free] = wanted[free]
    return result


def spaced(points: Floats, spacing: float) -> Floats:
    """Points on the same line, `spacing` metres from each other along it, or a little less."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    marks = np.linspace(0.0, along[-1], max(2, math.ceil(along[-1] / spacing) + 1))
    return np.column_stack([np.interp(marks, along, points[:, 0]), np.interp(marks, along, points[:, 1])])


def length(points: Floats) -> float:
    """Metres along a path, shape (n, 2)."""
    return sum(math.dist(a, b) for a, b in pairwise(points))


def _cell(grid_map: GridMap, point: tuple[float, float]) -> tuple[int, int]:
    rows, columns = grid_map.cells_of(np.array([point]))
    return int(rows[0]), int(columns[0])


def _at(point: tuple[float, float]) -> str:
    return f"({point[0]:.2f}, {point[1]:.2f})"
