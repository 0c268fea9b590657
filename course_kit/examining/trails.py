"""What a turtle of the checker's has painted: the lines of a star, their width, and what is beside them. No ROS."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw

from course_kit.examining.paths import Point, star
from course_kit.turtlesim.field import EXTENT, METER, MIDDLE, SIZE

YELLOW = (255, 255, 0)
RADIUS = 4.0  # metres
SAMPLES = 40  # of a line
TOLERANCE = 9  # pixels beside a line that still count as on it


@dataclass(frozen=True)
class StarSeen:
    """What there is of a star."""

    complete: int  # lines, of 5
    width: int  # pixels, of the level line
    elsewhere: int  # painted pixels that are not near a line


def _pixel(point: Point) -> tuple[int, int]:
    return round(point[0] * METER), round((EXTENT - point[1]) * METER)


def star_seen(turtlesim: Any) -> StarSeen:
    """Look at the trails of a TurtleSim of this process."""
    pixels = np.asarray(turtlesim.world.scene().trails)
    painted = pixels[..., 3] > 0
    yellow = painted & (pixels[..., :3] == YELLOW).all(axis=-1)
    lines = list(pairwise(star((MIDDLE, MIDDLE), RADIUS)))
    (left, y), (right, _) = lines[2]  # the level one, from 18° to 162°
    x, y = _pixel(((left + right) / 2, y))
    near = Image.new("L", (SIZE, SIZE), 0)
    draw = ImageDraw.Draw(near)
    for a, b in lines:
        draw.line((*_pixel(a), *_pixel(b)), 255, 2 * TOLERANCE)
        for end in (a, b):
            draw.circle(_pixel(end), TOLERANCE, 255)
    return StarSeen(
        complete=sum(_is_painted(yellow, *line) for line in lines),
        width=int(yellow[y - 15 : y + 16, x + 3].sum()),
        elsewhere=int((painted & (np.asarray(near) == 0)).sum()),
    )


def _is_painted(yellow: npt.NDArray[np.bool_], a: Point, b: Point) -> bool:
    """Whether a line is yellow nearly everywhere, within a pixel or three of where it should be."""
    hits = 0
    for part in np.arange(1, SAMPLES) / SAMPLES:
        x, y = _pixel((a[0] + (b[0] - a[0]) * part, a[1] + (b[1] - a[1]) * part))
        hits += bool(yellow[max(0, y - 3) : y + 4, max(0, x - 3) : x + 4].any())
    return hits >= 0.95 * (SAMPLES - 1)


def distance_to_end(turtlesim: Any) -> float:
    """Metres from turtle1 to where the star ends."""
    turtle = turtlesim.world.turtles.get("turtle1")
    if turtle is None:
        return math.inf
    end = star((MIDDLE, MIDDLE), RADIUS)[-1]
    return math.dist((turtle.x, EXTENT - turtle.depth), end)
