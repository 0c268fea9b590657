"""A picture of a world with its robots, seen from above. No ROS, no display."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw

from course_kit.robots.robot.shape import RADIUS, WHEEL_RADIUS, WHEEL_SEPARATION
from course_kit.robots.robot.world import Place, Wall, World

Floats = npt.NDArray[np.float64]
Color = tuple[int, int, int]
Points = Sequence[tuple[float, float]] | Floats

FLOOR: Color = (246, 245, 240)
OUTSIDE: Color = (226, 226, 222)
WALL: Color = (74, 78, 86)
HIT: Color = (214, 48, 49)
PATH: Color = (26, 138, 74)
ESTIMATE: Color = (20, 22, 26)
PARTICLE: Color = (140, 120, 40)
GOAL: Color = (124, 58, 160)
BODIES: list[Color] = [(38, 92, 168), (196, 108, 24), (20, 128, 128), (150, 60, 110)]
MARGIN = 0.15  # metres of the world's outside that are shown
WITHOUT_WORLD = 3.0  # metres around a robot that are shown where nothing tells how large the world is
_FINE = 2  # pixels drawn for each pixel shown, both ways, which smooths the edges


@dataclass(frozen=True)
class Cells:
    """An occupancy grid: -1 unknown, 0 free to 100 occupied; cell [0, 0] has its corner at x, y (metres)."""

    values: npt.NDArray[np.int8]  # shape (height, width)
    resolution: float  # metres, the side of a cell
    corner: tuple[float, float]
    heading: float = 0.0  # rad: how it is turned about that corner

    def bounds(self) -> tuple[float, float, float, float]:
        """The rectangle that holds it: x0, y0, x1, y1 in metres."""
        height, width = (count * self.resolution for count in self.values.shape)
        cosine, sine = math.cos(self.heading), math.sin(self.heading)
        corners = np.array([(0.0, 0.0), (width, 0.0), (0.0, height), (width, height)])
        x, y = (corners @ [[cosine, sine], [-sine, cosine]] + self.corner).T
        return float(x.min()), float(y.min()), float(x.max()), float(y.max())


@dataclass
class Seen:
    """One robot and what belongs to it; places and points in metres, in the world's frame."""

    place: Place
    hits: Points = ()  # where the beams of its laser end
    trail: Points = ()  # where it has been
    path: Points = ()  # where it means to go
    goal: tuple[float, ...] | None = None  # x, y, and the heading if there is one
    cells: Cells | None = None  # its map
    name: str = field(default="robot")
    estimate: Place | None = None  # where it takes itself to be
    particles: Points = ()  # where else it may be: x, y, heading


@dataclass(frozen=True)
class Scale:
    """Which pixel shows which place; x to the right, y up in metres, down in pixels."""

    left: float  # metres, of the picture's left edge
    top: float
    meter: float  # pixels
    width: int  # pixels
    height: int

    def pixel(self, x: float, y: float) -> tuple[float, float]:
        """Where a place (metres) is in the picture."""
        return (x - self.left) * self.meter, (self.top - y) * self.meter

    def place(self, across: float, down: float) -> tuple[float, float]:
        """The place (metres) that a pixel shows."""
        return self.left + across / self.meter, self.top - down / self.meter


def scale_of(world: World | None, robots: Sequence[Seen], size: int = 500) -> Scale:
    """The scale of a picture of `size` pixels on its longer side.

    It shows all of the world; without one, all maps, or else what is around the robots.
    """
    if world is not None:
        boxes = [world.bounds()]
    else:
        maps = [robot.cells.bounds() for robot in robots if robot.cells is not None]
        around = [(robot.place[0], robot.place[1]) for robot in robots] or [(0.0, 0.0)]
        far = WITHOUT_WORLD
        boxes = maps or [(x - far, y - far, x + far, y + far) for x, y in around]
    left, low = (min(box[side] for box in boxes) - MARGIN for side in (0, 1))
    right, top = (max(box[side] for box in boxes) + MARGIN for side in (2, 3))
    meter = size / max(right - left, top - low)
    return Scale(left, top, meter, round((right - left) * meter), round((top - low) * meter))


def draw(world: World | None, robots: Sequence[Seen], size: int = 500) -> Image.Image:
    """The world from above as an RGB image, `size` pixels on its longer side.

    `info["Description"]` says in words what is there: the key that PNG files have for it.
    """
    scale = scale_of(world, robots, size)
    fine = Scale(scale.left, scale.top, scale.meter * _FINE, scale.width * _FINE, scale.height * _FINE)
    image = Image.new("RGB", (fine.width, fine.height), OUTSIDE if world is None else FLOOR)
    for robot in robots:
        if robot.cells is not None:
            _paste_cells(image, fine, robot.cells)
    if world is not None:
        walls = _walls(world, fine)
        image.paste(WALL, (0, 0), walls)
    pen = _Pen(image, fine)
    for number, robot in enumerate(robots):
        pen.trail(robot, BODIES[number % len(BODIES)])
    for number, robot in enumerate(robots):
        pen.robot(robot.place, BODIES[number % len(BODIES)])
    picture = image.reduce(_FINE)
    picture.info["Description"] = in_words(world, robots)
    return picture


def in_words(world: World | None, robots: Sequence[Seen]) -> str:
    """Where the robots are, and where they mean to go."""
    told = []
    for robot in robots:
        parts = [f"{robot.name} at {_in_words(robot.place)}"]
        if robot.estimate is not None:
            parts.append(f"which it takes to be {_in_words(robot.estimate)}")
        if robot.goal is not None:
            parts.append(f"its goal at {_spot(*robot.goal[:2])}")
        if len(robot.path):
            parts.append(f"a plan of {_length(robot.path):.2f} m")
        if len(robot.hits):
            parts.append(f"{len(robot.hits)} hit{'s' if len(robot.hits) > 1 else ''} of its laser")
        if robot.cells is not None:
            parts.append(f"a map of which {100 * (robot.cells.values >= 0).mean():.0f} % are known")
        told.append(", ".join(parts))
    where = f"The world {world.name}" if world is not None else "What is known of the world"
    return f"{where} from above: {'; '.join(told) or 'no robot'}."


def _length(points: Points) -> float:
    return float(np.hypot(*np.diff(np.asarray(points, np.float64), axis=0).T).sum())


def _in_words(place: Place) -> str:
    return f"{_spot(*place[:2])}, heading {round(place[2], 2) + 0.0:.2f} rad"


def _spot(x: float, y: float) -> str:
    return f"({x:.2f}, {y:.2f}) m"


@lru_cache(maxsize=4)
def _walls(world: World, scale: Scale) -> Image.Image:
    """All that stands, as a mask."""
    mask = Image.new("L", (scale.width, scale.height), 0)
    pen = ImageDraw.Draw(mask)
    for wall in world.walls:
        pen.polygon([scale.pixel(*corner) for corner in corners(wall)], 255)
    for pillar in world.pillars:
        pen.ellipse(_box(scale, pillar.x, pillar.y, pillar.radius), 255)
    return mask


def corners(wall: Wall) -> list[tuple[float, float]]:
    """The four corners of a wall, one after another around it, m."""
    along = math.cos(wall.heading) * wall.length / 2, math.sin(wall.heading) * wall.length / 2
    across = -math.sin(wall.heading) * wall.thickness / 2, math.cos(wall.heading) * wall.thickness / 2
    signs = ((1, 1), (1, -1), (-1, -1), (-1, 1))
    return [(wall.x + a * along[0] + b * across[0], wall.y + a * along[1] + b * across[1]) for a, b in signs]


def _box(scale: Scale, x: float, y: float, radius: float) -> tuple[float, float, float, float]:
    across, down = scale.pixel(x, y)
    reach = radius * scale.meter
    return across - reach, down - reach, across + reach, down + reach


def shades(cells: Cells) -> Image.Image:
    """A map, a pixel a cell, the first row at the top: free is white, occupied dark, unknown grey."""
    known = cells.values >= 0
    return Image.fromarray(np.where(known, 255 - 1.7 * np.clip(cells.values, 0, 100), 206).astype(np.uint8))


def _paste_cells(image: Image.Image, scale: Scale, cells: Cells) -> None:
    """Draw a map as it lies, which may be turned."""
    # From pixels of the picture to cells: what Image.transform() wants to know.
    cosine, sine = math.cos(cells.heading) / cells.resolution, math.sin(cells.heading) / cells.resolution
    left, top, size = scale.left - cells.corner[0], scale.top - cells.corner[1], 1 / scale.meter
    to_column = (cosine * size, -sine * size, cosine * left + sine * top)
    to_row = (-sine * size, -cosine * size, cosine * top - sine * left)
    shaded = shades(cells)
    there = Image.new("L", shaded.size, 255)
    drawn, mask = (one.transform(image.size, Image.Transform.AFFINE, (*to_column, *to_row)) for one in (shaded, there))
    image.paste(drawn.convert("RGB"), (0, 0), mask)


class _Pen:
    """Draws on a picture in metres."""

    def __init__(self, image: Image.Image, scale: Scale) -> None:
        self._draw = ImageDraw.Draw(image)
        self._scale = scale

    def trail(self, robot: Seen, color: Color) -> None:
        """All of a robot but itself."""
        self._line(robot.trail, _lighter(color), 2)
        self._line(robot.path, PATH, 3)
        for x, y in np.asarray(robot.hits, np.float64).reshape(-1, 2):
            across, down = self._scale.pixel(x, y)
            self._draw.ellipse((across - 2, down - 2, across + 2, down + 2), HIT)
        for x, y, heading in np.asarray(robot.particles, np.float64).reshape(-1, 3):
            tip = x + 0.12 * math.cos(heading), y + 0.12 * math.sin(heading)
            self._line([(x, y), tip], PARTICLE, 1)
        if robot.goal is not None:
            self._goal(robot.goal)
        if robot.estimate is not None:
            self._estimate(robot.estimate)

    def robot(self, place: Place, color: Color) -> None:
        """The robot itself: its body, its wheels, and a nose where it looks."""
        x, y, heading = place
        for side in (1, -1):
            wheel = [
                (a * WHEEL_RADIUS, side * WHEEL_SEPARATION / 2 + b * 0.012)
                for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1))
            ]
            self._polygon(place, wheel, (34, 36, 40))
        self._draw.ellipse(_box(self._scale, x, y, RADIUS * 0.86), color, _darker(color), 2)
        nose = [(RADIUS * 0.8, 0.0), (RADIUS * 0.05, RADIUS * 0.42), (RADIUS * 0.05, -RADIUS * 0.42)]
        self._polygon((x, y, heading), nose, (255, 255, 255))

    def _goal(self, goal: tuple[float, ...]) -> None:
        x, y = goal[:2]
        for radius in (RADIUS, RADIUS * 0.45):
            self._draw.ellipse(_box(self._scale, x, y, radius), outline=GOAL, width=4)
        if len(goal) > 2:
            tip = x + 2.2 * RADIUS * math.cos(goal[2]), y + 2.2 * RADIUS * math.sin(goal[2])
            self._line([(x, y), tip], GOAL, 4)

    def _estimate(self, place: Place) -> None:
        x, y, heading = place
        self._draw.ellipse(_box(self._scale, x, y, RADIUS * 1.3), outline=ESTIMATE, width=4)
        across, up = RADIUS * math.cos(heading), RADIUS * math.sin(heading)
        self._line([(x + reach * across, y + reach * up) for reach in (1.3, 2.2)], ESTIMATE, 2)

    def _line(self, points: Points, color: Color, width: int) -> None:
        if len(points) > 1:
            self._draw.line([self._scale.pixel(x, y) for x, y in points], color, width * _FINE, joint="curve")

    def _polygon(self, place: Place, points: Points, color: Color) -> None:
        x, y, heading = place
        cosine, sine = math.cos(heading), math.sin(heading)
        turned = [(x + a * cosine - b * sine, y + a * sine + b * cosine) for a, b in points]
        self._draw.polygon([self._scale.pixel(*point) for point in turned], color)


def _lighter(color: Color) -> Color:
    red, green, blue = ((part + 255) // 2 for part in color)
    return red, green, blue


def _darker(color: Color) -> Color:
    red, green, blue = (part * 6 // 10 for part in color)
    return red, green, blue
