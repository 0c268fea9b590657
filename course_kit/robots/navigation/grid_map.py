"""A map of cells as a numpy array: which cell a point is in, how far the next wall is. What /map says, without ROS."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from course_kit.robots.navigation.places import Floats

Cells = npt.NDArray[np.int8]
Indices = npt.NDArray[np.intp]
UNKNOWN = -1
FREE, OCCUPIED = 25, 65  # of 100: at most, at least; between them nothing is sure
BESIDE = 0.15  # metres from a wall at which the laser may see it, for the robot is not quite where it thinks
NONE_NEAR = 1e3  # metres to the next wall in a map that has none


@dataclass(frozen=True, eq=False)
class GridMap:
    """Cells of shape (height, width): -1 unknown, 0 free to 100 occupied; [0, 0] has its corner at the origin.

    Rows follow y, columns x: the first row is the southernmost. `resolution` is the side of a cell in metres.
    """

    cells: Cells
    resolution: float
    origin: tuple[float, float]  # x, y in m of the outer corner of cell [0, 0]

    def cells_of(self, points: Floats) -> tuple[Indices, Indices]:
        """Rows and columns of the cells in which points lie, shape (n, 2); they may be outside of the map."""
        columns, rows = np.floor((points - np.array(self.origin)) / self.resolution).astype(np.intp).T
        return rows, columns

    def centres(self, rows: Indices, columns: Indices) -> Floats:
        """The middles of cells in metres, shape (n, 2)."""
        return (np.column_stack([columns, rows]) + 0.5) * self.resolution + np.array(self.origin)

    def inside(self, rows: Indices, columns: Indices) -> npt.NDArray[np.bool_]:
        """Which of the cells the map has."""
        height, width = self.cells.shape
        return (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)

    def at(self, points: Floats) -> Cells:
        """The values of the cells in which points lie; unknown outside of the map."""
        rows, columns = self.cells_of(points)
        inside = self.inside(rows, columns)
        values = np.full(len(points), UNKNOWN, np.int8)
        values[inside] = self.cells[rows[inside], columns[inside]]
        return values

    @cached_property
    def to_wall(self) -> Floats:
        """Metres from the middle of each cell to that of the nearest occupied one, shape (height, width)."""
        from scipy.ndimage import distance_transform_edt  # takes its time, and not everybody asks

        occupied = self.cells >= OCCUPIED
        if not occupied.any():
            return np.full(self.cells.shape, NONE_NEAR)
        return np.asarray(distance_transform_edt(~occupied, sampling=self.resolution), np.float64)

    def wall_distances(self, points: Floats) -> Floats:
        """The same for points, shape (n, 2), by the cells in which they lie; NONE_NEAR outside of the map."""
        rows, columns = self.cells_of(points)
        inside = self.inside(rows, columns)
        distances = np.full(len(points), NONE_NEAR)
        distances[inside] = self.to_wall[rows[inside], columns[inside]]
        return distances

    def with_hits(self, points: Floats) -> GridMap:
        """The same map with what the laser sees besides: cells in which points lie, shape (n, 2), are occupied.

        Points within BESIDE of a wall are that wall.
        """
        points = points[self.wall_distances(points) > BESIDE]
        rows, columns = self.cells_of(points)
        inside = self.inside(rows, columns)
        cells = self.cells.copy()
        cells[rows[inside], columns[inside]] = 100
        return GridMap(cells, self.resolution, self.origin)
