"""Compares a map with the true world and with the scans, and names the mistake of a wrong one."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from course_kit.robots.navigation.grid_map import GridMap
from course_kit.robots.navigation.places import Floats, Place, between, moved
from course_kit.robots.robot.world import World

CELL = 0.05  # m
FREE, WALL = 25, 65
RIGHT, TRUE_WALLS, FLOOR_SEEN, WALLS_SEEN = 0.97, 0.97, 0.8, 2 / 3
FAR = 0.1  # m from all true walls: no wall is there
BESIDE = 0.075  # m from a true wall at which a cell may still be that wall


@dataclass(frozen=True)
class Judged:
    """Shares, 0 to 1: of its cells and its walls that are right, of the floor and walls seen that it has."""

    right: float
    true_walls: float
    floor: float
    walls: float

    @property
    def is_good(self) -> bool:
        """True if it is as good as the exercise asks."""
        seen = self.floor >= FLOOR_SEEN and self.walls >= WALLS_SEEN
        return seen and self.right >= RIGHT and self.true_walls >= TRUE_WALLS


def judge(found: GridMap, world: World, reference: GridMap, move: Place = (0.0, 0.0, 0.0)) -> Judged:
    """How good a map is; as it would be, moved by a place."""
    rows, columns = np.nonzero((found.cells >= 0) & ((found.cells <= FREE) | (found.cells >= WALL)))
    points: Floats = moved(found.centres(rows, columns), move)
    clear = world.clearances(*points.T)
    is_wall = found.cells[rows, columns] >= WALL
    inside = _inside(points, world)
    right = np.where(is_wall, np.abs(clear) < BESIDE, (clear > -CELL) & inside)
    walls = reference.centres(*np.nonzero(reference.cells >= WALL))
    floor = reference.centres(*np.nonzero((reference.cells >= 0) & (reference.cells <= FREE)))
    back = between(move, (0.0, 0.0, 0.0))
    at_floor = found.at(moved(floor, back))
    return Judged(
        float(right.mean()) if len(right) else 0.0,
        float((np.abs(clear[is_wall]) < FAR).mean()) if is_wall.any() else 0.0,
        float(((at_floor >= 0) & (at_floor <= FREE)).mean()),
        float(_near_wall(found, moved(walls, back)).mean()),
    )


def _inside(points: Floats, world: World) -> npt.NDArray[np.bool_]:
    x0, y0, x1, y1 = world.bounds()
    return (points[:, 0] > x0) & (points[:, 0] < x1) & (points[:, 1] > y0) & (points[:, 1] < y1)


def _near_wall(found: GridMap, points: Floats) -> npt.NDArray[np.bool_]:
    """Return True if the map has a wall in the cell of each point or beside it."""
    return np.asarray(found.wall_distances(points) < 1.5 * CELL)


def cause(found: GridMap, world: World, reference: GridMap, odoms: Sequence[Place], walled: GridMap) -> str:
    """What was mixed up, as a hint: how good the map would be otherwise.

    `odoms`: where odom was in map. `walled`: what `reference` would be if a beam that hit nothing had hit its end.
    """
    cells = found.cells

    def is_good(changed: GridMap, move: Place = (0.0, 0.0, 0.0)) -> bool:
        judged = judge(changed, world, reference, move)
        return judged.right > 0.93 and judged.walls > 0.5

    if is_good(GridMap(cells[::-1].copy(), CELL, found.origin)):
        return "It is upside down: the first row of `data` is the one with the lowest y."
    turned = np.ascontiguousarray(cells.reshape(cells.shape[::-1]).T)  # as if `data` were column by column
    if is_good(GridMap(turned, CELL, found.origin)) or is_good(GridMap(cells.T.copy(), CELL, found.origin[::-1])):
        return "Rows and columns are swapped: in `data`, x runs first, row by row up y; an array is [row, column]."
    as_it_is = judge(found, world, reference)
    moved_ones = [judge(found, world, reference, odom).walls for odom in odoms[:: max(1, len(odoms) // 10)]]
    if max(moved_ones, default=0.0) > max(0.3, 1.5 * as_it_is.walls):
        return (
            "Its places are those of odom, under the name of map: look up where the scan's frame is in `map`; the link "
            "map → odom is told, and not zero."
        )
    shift = _best_shift(found, reference)
    is_off = as_it_is.walls < WALLS_SEEN and math.hypot(*shift) > 2 * CELL
    if is_off and is_good(found, (*shift, 0.0)):
        return (
            f"It is shifted by ({-shift[0]:.2f}, {-shift[1]:.2f}) m: `info.origin` is the outer corner of the first "
            "cell, in map."
        )
    if as_it_is.walls > 0.5 and as_it_is.true_walls < TRUE_WALLS and _has_walls_of(walled, found, world):
        return "Walls stand in the midst of rooms: what is inf, or beyond range_max, has hit nothing."
    known = (found.cells >= 0).sum() / max(1, (reference.cells >= 0).sum())
    if known < 0.5:
        return (
            "Little is known at all: was every scan taken? It may come before the transforms of its moment; keep it "
            "until the next one has come, then look its stamp up."
        )
    return "Each scan is added from where base_scan is in map at the scan's stamp, with angles in radians from ahead."


def _best_shift(found: GridMap, reference: GridMap) -> tuple[float, float]:
    """Metres by which a map is to be moved so that the most of its walls lie on those of another."""
    from scipy.signal import correlate  # takes its time, and a right map does not ask

    walls, others = ((one.cells >= WALL).astype(float) for one in (found, reference))
    overlap = correlate(others, walls, method="fft")
    place = np.unravel_index(overlap.argmax(), overlap.shape)
    y, x = (int(end) - (size - 1) for end, size in zip(place, walls.shape, strict=True))
    return (
        x * CELL + reference.origin[0] - found.origin[0],
        y * CELL + reference.origin[1] - found.origin[1],
    )


def _has_walls_of(walled: GridMap, found: GridMap, world: World) -> bool:
    """Return True if most of a map's walls that are none are those of another."""
    points = found.centres(*np.nonzero(found.cells >= WALL))
    wrong = points[np.abs(world.clearances(*points.T)) >= FAR]
    return bool(len(wrong)) and float(_near_wall(walled, wrong).mean()) > 0.7
