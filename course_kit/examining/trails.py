"""What a turtle of the checker's has painted: the lines of a star, their width, and what is beside them. No ROS."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

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
    image = turtlesim.world.scene().trails
    corners = star((MIDDLE, MIDDLE), RADIUS)
    lines = list(pairwise(corners))
    complete = sum(_is_painted(image, *line) for line in lines)
    level = lines[2]  # from 18° to 162°
    x = round((level[0][0] + level[1][0]) / 2 * METER) + 3
    y = _pixel(level[0])[1]
    width = sum(
        image.getpixel((x, row))[:3] == YELLOW and image.getpixel((x, row))[3] > 0 for row in range(y - 15, y + 16)
    )
    allowed = Image.new("L", (SIZE, SIZE), 0)
    draw = ImageDraw.Draw(allowed)
    for a, b in lines:
        draw.line((*_pixel(a), *_pixel(b)), 255, 2 * TOLERANCE)
        for x0, y0 in (_pixel(a), _pixel(b)):
            draw.ellipse((x0 - TOLERANCE, y0 - TOLERANCE, x0 + TOLERANCE, y0 + TOLERANCE), 255)
    painted, near = image.getchannel("A").tobytes(), allowed.tobytes()
    elsewhere = sum(1 for alpha, ok in zip(painted, near, strict=True) if alpha and not ok)
    return StarSeen(complete, width, elsewhere)


def _is_painted(image: Image.Image, a: Point, b: Point) -> bool:
    """Whether a line is yellow nearly everywhere, within a pixel or three of where it should be."""
    hits = 0
    for number in range(1, SAMPLES):
        part = number / SAMPLES
        x, y = _pixel((a[0] + (b[0] - a[0]) * part, a[1] + (b[1] - a[1]) * part))
        around = [(x + dx, y + dy) for dx in range(-3, 4) for dy in range(-3, 4)]
        hits += any(_yellow(image.getpixel((px, py))) for px, py in around if 0 <= px < SIZE and 0 <= py < SIZE)
    return hits >= 0.95 * (SAMPLES - 1)


def _yellow(pixel: Any) -> bool:
    return pixel[3] > 0 and pixel[:3] == YELLOW


def distance_to_end(turtlesim: Any) -> float:
    """Metres from turtle1 to where the star ends."""
    turtle = turtlesim.world.turtles.get("turtle1")
    if turtle is None:
        return math.inf
    end = star((MIDDLE, MIDDLE), RADIUS)[-1]
    return math.dist((turtle.x, EXTENT - turtle.depth), end)
