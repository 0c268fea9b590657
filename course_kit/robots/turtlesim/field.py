"""The field the turtles walk on, with the trails they have drawn. No ROS."""

from __future__ import annotations

from ctypes import c_float
from typing import Any

from PIL import Image, ImageDraw

SIZE = 500  # pixels, both ways
METER = 45  # pixels


def float32(value: float) -> float:
    """`value` as a float32 message field holds it; what is too big becomes infinite, as in C."""
    return c_float(value).value


EXTENT = float32((SIZE - 1) / METER)  # metres, both ways
MIDDLE = float32(EXTENT / 2)

Color = tuple[int, int, int]
Point = tuple[float, float]  # metres from the top left corner: x to the right, y down

BLANK = (255, 255, 255, 0)  # where nobody drew: transparent, and white for a colour sensor
_MARGIN = 256.0  # pixels around the field that a line may still be seen from; the widest pen has 255


class Field:
    """The trails, as an RGBA image of 500 x 500 pixels that is transparent where nobody drew."""

    def __init__(self) -> None:
        self.image = Image.new("RGBA", (SIZE, SIZE), BLANK)
        self._draw = ImageDraw.Draw(self.image)
        self._pixels: Any = self.image.load()

    def clear(self) -> None:
        """Wipe every trail away."""
        self.image.paste(BLANK, (0, 0, SIZE, SIZE))

    def draw_line(self, start: Point, end: Point, color: Color, width: int) -> None:
        """Draw a line between two points (metres); `width` in pixels. Only what lies on the field is seen."""
        clipped = _clip((start[0] * METER, start[1] * METER), (end[0] * METER, end[1] * METER))
        if clipped is None:
            return
        (x0, y0), (x1, y1) = ((_pixel(x), _pixel(y)) for x, y in clipped)
        self._draw.line((x0, y0, x1, y1), color, width)
        if width > 1:  # else short steps in a curve leave gaps between them
            self._draw_end(x0, y0, color, width)
            self._draw_end(x1, y1, color, width)

    def color_at(self, point: Point) -> Color:
        """The colour of the pixel at a point of the field (metres); white off a trail."""
        red, green, blue, _ = self._pixels[_pixel(point[0] * METER), _pixel(point[1] * METER)]
        return red, green, blue

    def _draw_end(self, x: int, y: int, color: Color, width: int) -> None:
        left, top = x - width // 2, y - width // 2
        box = (left, top, left + width - 1, top + width - 1)
        if width <= 3:
            self._draw.rectangle(box, color)
        else:
            self._draw.ellipse(box, color)


def _pixel(value: float) -> int:
    return int(value + 0.5) if value >= 0 else -int(0.5 - value)


def _clip(start: Point, end: Point) -> tuple[Point, Point] | None:
    """The part of a line (pixels) that lies on the field or near it; None if there is none."""
    low, high = -_MARGIN, SIZE + _MARGIN
    ends = [start, end]
    for axis in (0, 1):
        for bound, outside in ((low, min), (high, max)):
            beyond = [point[axis] != bound and outside(point[axis], bound) == point[axis] for point in ends]
            if all(beyond):
                return None
            if any(beyond):
                ends[beyond.index(True)] = _crossing(ends[0], ends[1], axis, bound)
    return ends[0], ends[1]


def _crossing(start: Point, end: Point, axis: int, bound: float) -> Point:
    """Where a line has the coordinate `bound` on an axis."""
    other = 1 - axis
    share = (bound - start[axis]) / (end[axis] - start[axis])
    across = start[other] + share * (end[other] - start[other])
    return (bound, across) if axis == 0 else (across, bound)
