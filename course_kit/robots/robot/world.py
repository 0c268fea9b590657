"""Walls and pillars of a robot's world, seen from above, and how far they are. Pure numpy, no physics.

The world's frame is `map`: x and y in m, angles in rad, counter-clockwise from x.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from course_kit.robots.robot.shape import LONGEST

Floats = npt.NDArray[np.float64]
Cells = npt.NDArray[np.int8]
Place = tuple[float, float, float]  # x, y in m, heading in rad


@dataclass(frozen=True)
class Wall:
    """A box seen from above: its centre, its sides in m, the long one turned by heading (rad)."""

    x: float
    y: float
    length: float
    thickness: float
    heading: float = 0.0


@dataclass(frozen=True)
class Pillar:
    """A round pillar; m."""

    x: float
    y: float
    radius: float


@dataclass(frozen=True)
class World:
    """Walls and pillars, where a robot starts, and places worth going to (x, y in m); seed None: read from a file."""

    name: str
    walls: tuple[Wall, ...]
    pillars: tuple[Pillar, ...]
    start: Place
    goals: tuple[tuple[float, float], ...]
    seed: int | None = None

    def bounds(self) -> tuple[float, float, float, float]:
        """The rectangle that holds all that stands: x0, y0, x1, y1 in m."""
        boxes = [(one.x, one.y, *_half_sides(one)) for one in self.walls]
        boxes += [(one.x, one.y, one.radius, one.radius) for one in self.pillars]
        x, y, half_x, half_y = np.array(boxes).T
        edges = ((x - half_x).min(), (y - half_y).min(), (x + half_x).max(), (y + half_y).max())
        x0, y0, x1, y1 = (round(float(one), 9) for one in edges)
        return x0, y0, x1, y1

    def distances(self, x: npt.ArrayLike, y: npt.ArrayLike, angles: npt.ArrayLike, longest: float = LONGEST) -> Floats:
        """Metres from (x, y) along each angle to the first thing; inf where that is more than `longest`, 0 inside one.

        x, y and angles are numbers or arrays that broadcast together.
        """
        x, y, angles = np.broadcast_arrays(*(np.asarray(one, np.float64) for one in (x, y, angles)))
        east, north = np.cos(angles), np.sin(angles)
        nearest = np.full(angles.shape, np.inf)
        for wall in self.walls:
            np.minimum(nearest, _to_wall(wall, x, y, east, north), out=nearest)
        for pillar in self.pillars:
            np.minimum(nearest, _to_pillar(pillar, x, y, east, north), out=nearest)
        return np.where(nearest > longest, np.inf, nearest)

    def clearance(self, x: float, y: float) -> float:
        """Metres from (x, y) to the nearest wall or pillar; negative inside one."""
        return float(self.clearances(x, y))

    def clearances(self, x: npt.ArrayLike, y: npt.ArrayLike) -> Floats:
        """The same for arrays that broadcast together."""
        x, y = np.broadcast_arrays(np.asarray(x, np.float64), np.asarray(y, np.float64))
        nearest = np.full(x.shape, np.inf)
        for wall in self.walls:
            np.minimum(nearest, _outside_wall(wall, x, y), out=nearest)
        for one in self.pillars:
            np.minimum(nearest, np.hypot(x - one.x, y - one.y) - one.radius, out=nearest)
        return nearest

    def occupancy(self, resolution: float = 0.05) -> tuple[Cells, tuple[float, float]]:
        """The true map: cells (height, width), 0 free and 100 occupied, and x, y of the corner of cell [0, 0].

        A cell is occupied where something covers its middle or comes within a quarter of a cell of it.
        """
        corner, x, y = self.cell_middles(resolution)
        cells = np.where(self.clearances(x[None, :], y[:, None]) < resolution / 4, 100, 0)
        return cells.astype(np.int8), corner

    def cell_middles(self, resolution: float) -> tuple[tuple[float, float], Floats, Floats]:
        """The cells of the map: x, y of the corner of cell [0, 0], x of the columns' middles, y of the rows'."""
        x0, y0, x1, y1 = self.bounds()
        # On multiples of the resolution, so that maps of all worlds have their cells in the same places.
        left, bottom = (math.floor(low / resolution + 1e-9) for low in (x0, y0))
        right, top = (math.ceil(high / resolution - 1e-9) for high in (x1, y1))
        x, y = (
            (np.arange(low, high, dtype=np.float64) + 0.5) * resolution for low, high in ((left, right), (bottom, top))
        )
        return (left * resolution, bottom * resolution), x, y


def _half_sides(wall: Wall) -> tuple[float, float]:
    """Half the sides, along x and y, of the rectangle around a turned wall."""
    along, across = abs(math.cos(wall.heading)), abs(math.sin(wall.heading))
    return (
        (wall.length * along + wall.thickness * across) / 2,
        (wall.length * across + wall.thickness * along) / 2,
    )


def _seen_from(wall: Wall, x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Vectors in the wall's own axes: along it and across it."""
    along, across = math.cos(wall.heading), math.sin(wall.heading)
    return along * x + across * y, along * y - across * x


def _to_wall(wall: Wall, x: Floats, y: Floats, east: Floats, north: Floats) -> Floats:
    """Metres along rays to a wall: each pair of parallel sides is a slab, and a ray is inside where it is in both."""
    place, ray = _seen_from(wall, x - wall.x, y - wall.y), _seen_from(wall, east, north)
    enters, leaves = np.zeros(east.shape), np.full(east.shape, np.inf)
    for at, way, half in zip(place, ray, (wall.length / 2, wall.thickness / 2), strict=True):
        way = np.where(way == 0.0, 1e-300, way)  # along a slab: in it for ever, or never
        with np.errstate(over="ignore"):
            one, other = (-half - at) / way, (half - at) / way
        enters = np.maximum(enters, np.minimum(one, other))
        leaves = np.minimum(leaves, np.maximum(one, other))
    return np.where(enters <= leaves, enters, np.inf)


def _to_pillar(pillar: Pillar, x: Floats, y: Floats, east: Floats, north: Floats) -> Floats:
    """Metres along rays to a pillar."""
    dx, dy = pillar.x - x, pillar.y - y
    along = east * dx + north * dy  # to the point of the ray that is nearest to the middle
    half = pillar.radius**2 - (dx**2 + dy**2 - along**2)  # squared, of what the pillar cuts out of the ray
    chord = np.sqrt(np.maximum(half, 0.0))
    return np.where((half > 0) & (along + chord > 0), np.maximum(along - chord, 0.0), np.inf)


def _outside_wall(wall: Wall, x: Floats, y: Floats) -> Floats:
    """Metres from points to a wall's sides; negative inside."""
    along, across = _seen_from(wall, x - wall.x, y - wall.y)
    beside, before = np.abs(along) - wall.length / 2, np.abs(across) - wall.thickness / 2
    outside = np.hypot(np.maximum(beside, 0.0), np.maximum(before, 0.0))
    return outside + np.minimum(np.maximum(beside, before), 0.0)
