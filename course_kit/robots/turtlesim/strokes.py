"""Trails whose last lines can still be drawn anew: what a pen was like is sometimes known later. No ROS."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

from PIL import Image

from course_kit.robots.turtlesim.field import Color, Field, Point
from course_kit.robots.turtlesim.turtle import Pen

MOST = 10_000  # lines kept of turtles that never rest; older ones stay as they are


@dataclass
class Stroke:
    """A turtle's line between two points, with the pen that it is taken to have."""

    name: str
    start: Point
    end: Point
    pen: Pen
    settled: bool  # whether that is known

    def draw(self, field: Field) -> None:
        """Draw it, if the pen is down."""
        if self.pen.down:
            field.draw_line(self.start, self.end, self.pen.color, self.pen.width)


class Strokes:
    """A field, with the lines on it that are not settled, in order."""

    def __init__(self) -> None:
        self._field = Field()
        self._settled = Field()  # without those lines
        self._open: deque[Stroke] = deque()

    @property
    def image(self) -> Image.Image:
        """The trails: RGBA, 500 x 500."""
        return self._field.image

    def color_at(self, point: Point) -> Color:
        """The colour of a point, as turtlesim's sensor sees it."""
        return self._field.color_at(point)

    def draw(self, stroke: Stroke) -> None:
        """Draw one line more."""
        stroke.draw(self._field)
        self._open.append(stroke)
        self._keep_open()

    def settle(self, name: str, pen: Pen | None = None) -> bool:
        """A turtle's lines stay as they are, or as drawn by another pen; whether there were any."""
        lines = [stroke for stroke in self._open if stroke.name == name and not stroke.settled]
        for stroke in lines:
            stroke.pen, stroke.settled = pen or stroke.pen, True
        if lines and pen:
            self._field.image.paste(self._settled.image)
            for stroke in self._open:
                stroke.draw(self._field)
        self._keep_open()
        return bool(lines)

    def clear(self) -> None:
        """Wipe all away."""
        self._field.clear()
        self._settled.clear()
        self._open.clear()

    def put_below(self, trails: Image.Image) -> None:
        """Have a picture (RGBA, 500 x 500) below all that is drawn."""
        for field in (self._field, self._settled):
            below = trails.copy()
            below.alpha_composite(field.image)
            field.image.paste(below)

    def _keep_open(self) -> None:
        """Keep no line that is settled, unless an older one is not."""
        while self._open and (self._open[0].settled or len(self._open) > MOST):
            self._open.popleft().draw(self._settled)
