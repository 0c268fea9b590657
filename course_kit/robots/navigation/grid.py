"""A map from scans: what each cell is worth as log-odds, raised where a beam ends, lowered where it passed.

An example to read. For a cell that is occupied with probability p its log-odds are log(p / (1 - p)): what one scan
says is added, so that a thousand scans count as they should, and 0 is "nothing known". No ROS: the node is Mapper.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.ndimage import distance_transform_edt

from course_kit.robots.navigation.grid_map import OCCUPIED, UNKNOWN, Cells, GridMap, Indices
from course_kit.robots.navigation.places import Floats, Place

HIT = 0.9  # log-odds: a beam ends in a cell that is occupied with 71 %
PASS = -0.4  # and one that it passes is so with 40 %
SURE = 5.0  # no cell is surer than 99.3 %, or a door that opens would stay a wall for long
GROWTH = 1.0  # metres by which the map grows where a scan reaches over its edge


class Grid:
    """A map that grows with what it is shown; without scans it has no cells."""

    def __init__(self, resolution: float = 0.05) -> None:
        self.resolution = resolution  # metres, the side of a cell
        self._corner = np.zeros(2, np.intp)  # column and row of cell [0, 0], counted from the one at x = y = 0
        self.log_odds: Floats = np.zeros((0, 0))  # shape (height, width)
        # Of each cell: how many beams ended in it, the sum of their x, of their y.
        self._hits: Floats = np.zeros((0, 0, 3))

    @property
    def origin(self) -> tuple[float, float]:
        """x, y of the outer corner of cell [0, 0], m."""
        x, y = (self._corner * self.resolution).tolist()
        return x, y

    def add(self, place: Place, angles: Floats, ranges: Floats, longest: float) -> None:
        """Take over a scan that was made at a place: angles from its heading in rad, ranges in m.

        A range that is infinite, or above `longest`, saw nothing as far as that; one that is nan says nothing.
        """
        known = ~np.isnan(ranges)
        angles, ranges = angles[known] + place[2], ranges[known]
        hit = ranges <= longest
        far = np.where(hit, ranges, longest)
        directions = np.column_stack([np.cos(angles), np.sin(angles)])
        ends = np.array(place[:2]) + far[:, None] * directions
        self._make_room(np.vstack([ends, [place[:2]]]))
        # Points along all beams at once, two in each cell, up to one cell before the end.
        steps = np.arange(0.0, longest, self.resolution / 2)
        beam, step = np.nonzero(steps < far[:, None] - self.resolution)
        passed = np.array(place[:2]) + steps[step, None] * directions[beam]
        # Cells near the laser are passed by many beams: a scan counts once.
        ended = self._touched(ends[hit])
        self.log_odds[ended] += HIT
        self.log_odds[self._touched(passed) & ~ended] += PASS
        np.clip(self.log_odds, -SURE, SURE, out=self.log_odds)
        rows, columns = self._cells_of(ends[hit])
        np.add.at(self._hits, (rows, columns), np.column_stack([np.ones(len(rows)), ends[hit]]))

    def map(self) -> GridMap:
        """The cells as /map has them: -1 where nothing is known, else percent."""
        percent = np.rint(100 / (1 + np.exp(-self.log_odds))).astype(np.int8)
        cells: Cells = np.where(self.log_odds == 0, np.int8(UNKNOWN), percent)
        return GridMap(cells, self.resolution, self.origin)

    def nearest_walls(self) -> Floats:
        """For each cell a point of the nearest wall, x and y in m, shape (height, width, 2); nan without any wall.

        It is more exact than a cell: the mean of what beams have hit in the nearest occupied cell.
        """
        with np.errstate(invalid="ignore"):
            means = self._hits[..., 1:] / self._hits[..., :1]
        occupied = self.map().cells >= OCCUPIED
        if not occupied.any():
            return np.full_like(means, np.nan)
        rows, columns = distance_transform_edt(~occupied, return_distances=False, return_indices=True)
        return np.asarray(means[rows, columns])

    def _cells_of(self, points: Floats) -> tuple[Indices, Indices]:
        columns, rows = (self._counted(points) - self._corner).T
        return rows, columns

    def _counted(self, points: Floats) -> Indices:
        # Not from a corner in metres: when that moves, a point between two cells would now be in one, now in the other.
        return np.floor(points / self.resolution).astype(np.intp)

    def _touched(self, points: Floats) -> npt.NDArray[np.bool_]:
        touched = np.zeros(self.log_odds.shape, np.bool_)
        touched[self._cells_of(points)] = True
        return touched

    def _make_room(self, points: Floats) -> None:
        """Add rows and columns of unknown cells, so that all points lie within."""
        block = round(GROWTH / self.resolution)
        height, width = self.log_odds.shape
        cells = self._counted(points)
        if not self.log_odds.size:  # the first scan says where the map is
            self._corner = cells.min(axis=0)
        low, high = cells.min(axis=0) - self._corner, cells.max(axis=0) + 1 - self._corner
        # Whole blocks of cells: how many are missing on each side.
        left, below = (np.maximum(0, -(low // block)) * block).tolist()
        right, above = (np.maximum(0, -((np.array([width, height]) - high) // block)) * block).tolist()
        if left or below or right or above:
            self.log_odds = np.pad(self.log_odds, ((below, above), (left, right)))
            self._hits = np.pad(self._hits, ((below, above), (left, right), (0, 0)))
            self._corner = self._corner - (left, below)
