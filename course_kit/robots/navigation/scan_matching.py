"""A place corrected by its scan: the points that it hit are laid on the walls of the map, by Gauss-Newton.

An example to read. Each hit should lie on a wall: how far in front of it or behind it lies is its error. A small move
of the laser changes these errors by a slope each; the move that makes them least in all comes from three equations.
After some rounds the scan lies where it fits best.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from course_kit.robots.navigation.grid import Grid
from course_kit.robots.navigation.grid_map import UNKNOWN, GridMap
from course_kit.robots.navigation.places import Floats, Place, after, between, hits, inverse, moved, wrapped

ROUNDS = 12
NEAR = 0.2  # metres: a hit further from all walls is something that the map does not have yet
NOISE = 0.03  # metres by which a hit lies beside its wall: the laser's noise and the map's cells
STRAY = (0.005, 0.005, 0.01)  # m, m, rad by which odometry strays from scan to scan
SETTLED = 1e-4  # m and rad: a smaller step is the last
FEWEST = 20  # hits on walls of the map; fewer do not say where one is
NEIGHBOUR = 4  # beams: a wall leads from the hit so many before to that so many after
SHORTEST_WALL, LONGEST_WALL, BENT = 0.03, 0.8, 0.03  # metres between these two, and of the hit from their line


@dataclass(frozen=True, eq=False)
class Walls:
    """A map to match scans with: where the nearest wall is, seen from each of its cells."""

    map: GridMap
    nearest: Floats  # x, y in m, shape (height, width, 2)

    def offsets(self, points: Floats) -> tuple[Floats, npt.NDArray[np.bool_]]:
        """From the nearest walls to points, in m, both (n, 2), and of which points the map knows anything."""
        rows, columns = self.map.cells_of(points)
        known = self.map.at(points) != UNKNOWN
        return points - self.nearest[np.where(known, rows, 0), np.where(known, columns, 0)], known


def match(walls: Walls, guess: Place, points: Floats) -> Place:
    """The place near a guess at which the points, seen from there, lie on the walls of the map.

    Points in the order of their beams, shape (n, 2). Where they do not tell, as along a corridor, or too few lie on
    walls, it is the guess.
    """
    points, across = _on_walls(points)
    trust = NOISE**2 / np.array(STRAY) ** 2
    place = guess
    for _ in range(ROUNDS):
        at, normals = moved(points, place), moved(across, (0.0, 0.0, place[2]))
        offsets, known = walls.offsets(at)
        used = known & (np.hypot(*offsets.T) < NEAR)
        if used.sum() < FEWEST:
            return guess
        # Only what lies across its wall counts: along it a hit may be anywhere, also beyond the end that is known.
        errors = (offsets * normals).sum(axis=1)[used]
        normals, arms = normals[used], at[used] - place[:2]
        slopes = np.column_stack([normals, normals[:, 1] * arms[:, 0] - normals[:, 0] * arms[:, 1]])
        strayed = np.array([place[0] - guess[0], place[1] - guess[1], wrapped(place[2] - guess[2])])
        step = -np.linalg.solve(slopes.T @ slopes + np.diag(trust), slopes.T @ errors + trust * strayed)
        place = (place[0] + float(step[0]), place[1] + float(step[1]), wrapped(place[2] + float(step[2])))
        if np.abs(step).max() < SETTLED:
            break
    return place


def _on_walls(points: Floats) -> tuple[Floats, Floats]:
    """The points whose neighbours lie on a line with them, and the normals of these lines, both (n, 2)."""
    before, beyond = np.roll(points, NEIGHBOUR, axis=0), np.roll(points, -NEIGHBOUR, axis=0)
    along = beyond - before
    lengths = np.hypot(*along.T)
    normals = np.column_stack([-along[:, 1], along[:, 0]]) / np.maximum(lengths, 1e-9)[:, None]
    off = np.abs(((points - before) * normals).sum(axis=1))
    straight = (lengths > SHORTEST_WALL) & (lengths < LONGEST_WALL) & (off < BENT)
    return points[straight], normals[straight]


class Slam:
    """Where a laser is, and the map, both from scans and odometry: each scan is matched with the map, then added.

    `odom` is where the frame of odometry lies in the map: that of the start until a scan tells better.
    """

    def __init__(self, odom: Place = (0.0, 0.0, 0.0), resolution: float = 0.05, matching: bool = True) -> None:
        self.odom = odom
        self.grid = Grid(resolution)
        self._walls: Walls | None = None
        self._matching = matching
        self._added: Place | None = None

    def update(self, odometry: Place, angles: Floats, ranges: Floats, longest: float) -> Place:
        """Take over a scan, made where the laser is by odometry; return where it is in the map."""
        place = after(self.odom, odometry)
        if self._walls is not None:
            place = match(self._walls, place, hits(angles, np.where(ranges <= longest, ranges, math.inf)))
            self.odom = after(place, inverse(odometry))
        if self._added is None or _is_elsewhere(between(self._added, place)):
            self._added = place
            self.grid.add(place, angles, ranges, longest)
            if self._matching:
                self._walls = Walls(self.grid.map(), self.grid.nearest_walls())
        return place


def _is_elsewhere(step: Place) -> bool:
    """Return True if a scan there says anything new: at rest, each would make the map surer and no better."""
    return math.hypot(step[0], step[1]) > 0.02 or abs(step[2]) > 0.02
