"""A picture of the world: background, trails and turtles. No ROS, no display."""

from __future__ import annotations

import math
from functools import lru_cache

from PIL import Image, ImageDraw

from course_kit.robots.turtlesim.field import EXTENT, METER, SIZE, Color
from course_kit.robots.turtlesim.world import Scene

SHELLS: list[Color] = [
    (76, 153, 62),  # green
    (214, 116, 43),  # orange
    (166, 74, 150),  # purple
    (38, 143, 150),  # teal
    (196, 62, 62),  # red
    (196, 160, 40),  # yellow
    (226, 140, 172),  # pink
    (120, 96, 74),  # brown
]
_SKIN: Color = (150, 196, 96)
_EYE: Color = (30, 36, 28)
_FINE = 4  # pixels drawn for each pixel shown, which smooths the edges


def draw(scene: Scene, background: Color) -> Image.Image:
    """The scene as an RGB image of 500 x 500 pixels; background as red, green, blue from 0 to 255.

    `info["Description"]` says in words what is there: the key that PNG files have for it.
    """
    picture = Image.new("RGB", (SIZE, SIZE), background)
    picture.info["Description"] = in_words(scene)
    picture.paste(scene.trails, (0, 0), scene.trails)
    for figure in scene.figures:
        if not (-1 < figure.x < EXTENT + 1 and -1 < figure.depth < EXTENT + 1):
            continue  # spawned outside; the next tick brings it back to the wall
        turtle = turtle_image(figure.shell, round(math.degrees(figure.theta)) % 360)
        corner = (round(figure.x * METER - turtle.width / 2), round(figure.depth * METER - turtle.height / 2))
        picture.paste(turtle, corner, turtle)
    return picture


@lru_cache(maxsize=1)
def shells() -> Image.Image:
    """All kinds of turtle beside each other, looking right, RGBA, each twice as large as turtle_image()."""
    size = _upright(0).width * 2 // _FINE
    strip = Image.new("RGBA", (size * len(SHELLS), size))
    for shell in range(len(SHELLS)):
        strip.paste(_upright(shell).resize((size, size), Image.Resampling.LANCZOS), (size * shell, 0))
    return strip


def in_words(scene: Scene) -> str:
    """Where the turtles are, and where they have drawn."""
    told = [f"{one.name} at {_place(one.x, one.depth)}, heading {one.theta:.2f} rad" for one in scene.figures]
    drawn = scene.trails.getbbox(alpha_only=True)
    trails = "nothing is drawn"
    if drawn:
        left, top, right, bottom = (pixels / METER for pixels in drawn)
        trails = f"trails lie between {_place(left, bottom)} and {_place(right, top)}"
    return f"The turtles' field: {'; '.join(told) or 'no turtle'}; {trails}."


def _place(x: float, depth: float) -> str:
    return f"({x:.2f}, {EXTENT - depth:.2f}) m"


@lru_cache(maxsize=1024)
def turtle_image(shell: int, degrees: int) -> Image.Image:
    """A turtle from above, RGBA, 60 x 60 pixels: the `shell`-th of its world, turned counter-clockwise."""
    turned = _upright(shell % len(SHELLS)).rotate(degrees, Image.Resampling.BICUBIC)
    size = turned.width // _FINE
    return turned.resize((size, size), Image.Resampling.LANCZOS)


@lru_cache(maxsize=len(SHELLS))
def _upright(shell: int) -> Image.Image:
    """The turtle looking right, _FINE times as large as it is shown."""
    pen = _TurtlePen(60 * _FINE, METER / 2 * _FINE)
    color = SHELLS[shell]
    dark, light = _shade(color, 0.62), _shade(color, 1.22)
    skin_edge = _shade(_SKIN, 0.6)
    for side in (1, -1):
        pen.oval((0.50, 0.56 * side), (0.33, 0.15), 38 * side, _SKIN, skin_edge)  # front flipper
        pen.oval((-0.50, 0.50 * side), (0.26, 0.13), -38 * side, _SKIN, skin_edge)  # hind flipper
    pen.polygon([(-0.66, 0.07), (-0.96, 0.0), (-0.66, -0.07)], _SKIN, skin_edge)  # tail
    pen.oval((0.83, 0.0), (0.23, 0.19), 0, _SKIN, skin_edge)  # head
    for side in (1, -1):
        pen.oval((0.92, 0.095 * side), (0.042, 0.042), 0, _EYE, _EYE)
    pen.oval((0.0, 0.0), (0.72, 0.60), 0, color, dark)
    middle = [_on_oval(0.32, 0.27, angle) for angle in range(0, 360, 60)]
    for angle in range(0, 360, 60):  # seams from the middle plate to the rim
        pen.line([_on_oval(0.32, 0.27, angle), _on_oval(0.70, 0.58, angle)], dark)
    pen.polygon(middle, light, dark)
    return pen.image


class _TurtlePen:
    """Draws in half turtles: the middle of the shell is (0, 0), the nose (1, 0), the left side y > 0."""

    def __init__(self, size: int, scale: float) -> None:
        self.image = Image.new("RGBA", (size, size), (0, 0, 0, 0))
        self._draw = ImageDraw.Draw(self.image)
        self._middle, self._scale = size / 2, scale

    def polygon(self, points: list[tuple[float, float]], fill: Color, edge: Color) -> None:
        self._draw.polygon([self._place(point) for point in points], fill)
        self.line([*points, points[0]], edge)

    def line(self, points: list[tuple[float, float]], color: Color) -> None:
        self._draw.line([self._place(point) for point in points], color, round(1.3 * _FINE), joint="curve")

    def oval(
        self, middle: tuple[float, float], radii: tuple[float, float], degrees: float, fill: Color, edge: Color
    ) -> None:
        cosine, sine = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        around = (_on_oval(*radii, angle) for angle in range(0, 360, 6))
        points = [(middle[0] + x * cosine - y * sine, middle[1] + x * sine + y * cosine) for x, y in around]
        self.polygon(points, fill, edge)

    def _place(self, point: tuple[float, float]) -> tuple[float, float]:
        return self._middle + point[0] * self._scale, self._middle - point[1] * self._scale


def _on_oval(rx: float, ry: float, degrees: float) -> tuple[float, float]:
    return rx * math.cos(math.radians(degrees)), ry * math.sin(math.radians(degrees))


def _shade(color: Color, factor: float) -> Color:
    red, green, blue = (min(255, round(part * factor)) for part in color)
    return red, green, blue
