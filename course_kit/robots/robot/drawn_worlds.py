"""Worlds drawn from a seed: a floor plan, furniture, a start and goals.

All places where a robot has room hang together: furniture that would part them is left out.
"""

from __future__ import annotations

import math
import random
from dataclasses import replace

import numpy as np
import numpy.typing as npt
from scipy import ndimage

from course_kit.robots.robot.floor_plans import PLANS
from course_kit.robots.robot.shape import RADIUS
from course_kit.robots.robot.world import Floats, Pillar, Wall, World

# m: what a robot needs around its middle, 0.1 m to spare. Clearances beside most walls come in steps of 0.005 m; this
# lies between two, so that rounding decides nothing.
ROOM = RADIUS + 0.0975
SPACIOUS = 0.3  # m: the same at starts and goals
CELL = 0.05  # m, of the grid on which ways are looked for
GOALS = 3
Bools = npt.NDArray[np.bool_]


def draw(name: str, seed: int) -> World:
    """The world of this kind and seed."""
    chance = random.Random(f"{name} {seed}")
    walls, furniture = PLANS[name](chance)
    world = World(name, tuple(walls), (), (0.0, 0.0, 0.0), (), seed)
    (left, bottom), x, y = world.cell_middles(CELL)
    clear = world.clearances(x[None, :], y[:, None])
    for _ in range(furniture):
        piece = _piece(world, chance)
        less = np.minimum(clear, piece.clearances(x[None, :], y[:, None]))
        if _is_within(piece, world) and ndimage.label(less >= ROOM)[1] == 1:
            clear = less
            world = replace(world, walls=world.walls + piece.walls, pillars=world.pillars + piece.pillars)
    (start_x, start_y), *goals = (
        (round(left + (column + 0.5) * CELL, 3), round(bottom + (row + 0.5) * CELL, 3))
        for row, column in _far_apart(clear, chance)
    )
    heading = round(chance.uniform(-math.pi, math.pi), 2)
    return replace(world, start=(start_x, start_y, heading), goals=tuple(goals))


def _piece(world: World, chance: random.Random) -> World:
    """A world with one pillar or box alone, somewhere within this one."""
    nothing = replace(world, walls=(), pillars=())
    x0, y0, x1, y1 = world.bounds()
    x, y = round(chance.uniform(x0 + 0.3, x1 - 0.3), 2), round(chance.uniform(y0 + 0.3, y1 - 0.3), 2)
    if chance.random() < 0.4:
        return replace(nothing, pillars=(Pillar(x, y, round(chance.uniform(0.1, 0.25), 2)),))
    length, width = round(chance.uniform(0.5, 1.3), 2), round(chance.uniform(0.3, 0.6), 2)
    turned = chance.choice((0.0, math.pi / 2, round(chance.uniform(0.0, math.pi), 2)))
    return replace(nothing, walls=(Wall(x, y, length, width, turned),))


def _is_within(piece: World, world: World) -> bool:
    """Return True if it does not come out on the other side of the walls around."""
    x0, y0, x1, y1 = world.bounds()
    left, bottom, right, top = piece.bounds()
    return x0 <= left and y0 <= bottom and right <= x1 and top <= y1


def _far_apart(clear: Floats, chance: random.Random) -> list[tuple[int, int]]:
    """Rows and columns of a start and of goals, each a long way from those before it."""
    free = clear >= ROOM
    rows, columns = np.nonzero(clear >= SPACIOUS)
    cells = [chance.randrange(len(rows))]
    away = np.full(free.shape, np.inf)
    for _ in range(GOALS):
        away = np.minimum(away, _ways(free, rows[cells[-1]], columns[cells[-1]]))
        ways = away[rows, columns]
        cells.append(chance.choice(np.nonzero(ways >= 0.85 * ways.max())[0].tolist()))
    return [(int(rows[cell]), int(columns[cell])) for cell in cells]


def _ways(free: Bools, row: int, column: int) -> Floats:
    """How many cells the way from one to each other is, over their sides; those not free are inf."""
    ways = np.full(free.shape, np.inf)
    front = np.zeros(free.shape, bool)
    front[row, column] = True
    count = 0
    while front.any():
        ways[front] = count
        count += 1
        beside = np.zeros_like(front)
        beside[1:] |= front[:-1]
        beside[:-1] |= front[1:]
        beside[:, 1:] |= front[:, :-1]
        beside[:, :-1] |= front[:, 1:]
        front = beside & free & np.isinf(ways)
    return ways
