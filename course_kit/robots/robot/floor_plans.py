"""Floor plans drawn by chance: the walls of each kind of world, and how many pieces of furniture to try.

Python's random draws them, which gives the same numbers in all versions. Each plan hangs together.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from itertools import pairwise

from course_kit.robots.robot.world import Wall
from course_kit.robots.robot.worlds import THICKNESS, line

DOOR = (0.8, 1.0)  # m


def _outside(width: float, depth: float) -> list[Wall]:
    ends = ((0.0, 0.0, width, 0.0), (width, 0.0, width, depth), (0.0, depth, width, depth), (0.0, 0.0, 0.0, depth))
    return [line(*one) for one in ends]


def _empty(chance: random.Random) -> tuple[list[Wall], int]:
    """Four walls."""
    return _outside(round(chance.uniform(4, 7), 1), round(chance.uniform(4, 6), 1)), 0


def _rooms(chance: random.Random) -> tuple[list[Wall], int]:
    """A house that is parted, and its parts again, by walls with a door each."""
    walls = _outside(8.0, 6.0)
    doors: list[tuple[float, float]] = []

    def part(x0: float, y0: float, x1: float, y1: float) -> None:
        width, depth = x1 - x0, y1 - y0
        if max(width, depth) < 3.6 or (width * depth < 9 and chance.random() < 0.3):
            return
        upright = width > depth
        low, high = (x0, x1) if upright else (y0, y1)
        begin, end = (y0, y1) if upright else (x0, x1)
        # No wall ends in the door of another.
        taken = [x if upright else y for x, y in doors if x0 <= x <= x1 and y0 <= y <= y1]
        places = [round(low + 1.6 + 0.1 * step, 1) for step in range(round((high - low - 3.2) * 10) + 1)]
        places = [at for at in places if all(abs(at - door) > 0.7 for door in taken)]
        if not places:
            return
        at, size = chance.choice(places), chance.uniform(*DOOR)
        door = round(chance.uniform(begin + size / 2 + 0.2, end - size / 2 - 0.2), 2)
        half = size / 2 + THICKNESS / 2
        for one, other in ((begin, door - half), (door + half, end)):
            walls.append(line(at, one, at, other) if upright else line(one, at, other, at))
        doors.append((at, door) if upright else (door, at))
        for parts in ((x0, y0, at, y1), (at, y0, x1, y1)) if upright else ((x0, y0, x1, at), (x0, at, x1, y1)):
            part(*parts)

    part(0.0, 0.0, 8.0, 6.0)
    return walls, 8


def _maze(chance: random.Random) -> tuple[list[Wall], int]:
    """Passages a metre wide: a way to each cell, and some round ways."""
    columns, rows = chance.choice(((6, 5), (7, 5), (7, 6), (8, 5)))
    open_sides: set[frozenset[tuple[int, int]]] = set()
    seen, way = {(0, 0)}, [(0, 0)]
    while way:
        here = way[-1]
        there = [cell for cell in _beside(here, columns, rows) if cell not in seen]
        if there:
            way.append(chance.choice(there))
            seen.add(way[-1])
            open_sides.add(frozenset((here, way[-1])))
        else:
            way.pop()
    sides = [
        frozenset((cell, other)) for cell in sorted(seen) for other in _beside(cell, columns, rows) if cell < other
    ]
    closed = [side for side in sides if side not in open_sides]
    for side in chance.sample(closed, len(closed) // 8):
        closed.remove(side)
    walls = _outside(float(columns), float(rows))
    for (_, row), (to_column, to_row) in map(sorted, closed):
        x, y = float(to_column), float(to_row)
        walls.append(line(x, y, x, y + 1) if row == to_row else line(x, y, x + 1, y))
    return walls, 0


def _beside(cell: tuple[int, int], columns: int, rows: int) -> list[tuple[int, int]]:
    column, row = cell
    around = ((column + 1, row), (column - 1, row), (column, row + 1), (column, row - 1))
    return [(x, y) for x, y in around if 0 <= x < columns and 0 <= y < rows]


def _office(chance: random.Random) -> tuple[list[Wall], int]:
    """Offices on both sides of a corridor, a door each."""
    width, depth = 9.0, 6.0
    walls = _outside(width, depth)
    middle, half = round(chance.uniform(2.8, 3.2), 2), round(chance.uniform(0.6, 0.75), 2)
    for low, high, corridor in ((0.0, middle - half, middle - half), (middle + half, depth, middle + half)):
        count = chance.choice((2, 3, 4))
        between = [round(width * number / count + chance.uniform(-0.3, 0.3), 2) for number in range(1, count)]
        edges = [0.0, *between, width]
        walls += [line(x, low, x, high) for x in between]
        begun = 0.0
        for left, right in pairwise(edges):
            size = chance.uniform(*DOOR)
            door = round(chance.uniform(left + size / 2 + 0.2, right - size / 2 - 0.2), 2)
            walls.append(line(begun, corridor, door - size / 2 - THICKNESS / 2, corridor))
            begun = door + size / 2 + THICKNESS / 2
        walls.append(line(begun, corridor, width, corridor))
    return walls, 10


PLANS: dict[str, Callable[[random.Random], tuple[list[Wall], int]]] = {
    "empty": _empty,
    "rooms": _rooms,
    "maze": _maze,
    "office": _office,
}
