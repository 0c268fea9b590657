"""The worlds that there are: small files beside this module, and as many more as there are seeds. No ROS."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path
from typing import Any

import yaml

from course_kit.robots.robot.world import Pillar, Wall, World

FILES = Path(__file__).with_name("worlds")
THICKNESS = 0.1  # m, of walls, unless a file says otherwise
NAMES = ("empty", "rooms", "maze", "office")


def world(name: str = "rooms", seed: int | None = None) -> World:
    """A world by its name ("empty", "rooms", "maze", "office"); with a seed, another of its kind, the same each time.

    In each, a robot can drive from the start to every other place where it has room. ValueError for other names.
    """
    if name not in NAMES:
        raise ValueError(
            f"There is no world {name!r}; there are {', '.join(NAMES)}. Write it like world('rooms', seed=3)"
        )
    if seed is None:
        return read(FILES / f"{name}.yaml")
    if isinstance(seed, bool) or not isinstance(seed, int):
        raise ValueError(f"seed must be a whole number, not {seed!r}. Write it like world({name!r}, seed=3)")
    from course_kit.robots.robot.drawn_worlds import draw  # scipy, which takes its time to be imported

    return draw(name, seed)


@cache
def read(path: Path) -> World:
    """The world of a file; it is called after the file."""
    says: dict[str, Any] = yaml.safe_load(path.read_text())
    walls = [line(x0, y0, x1, y1, says.get("thickness", THICKNESS)) for x0, y0, x1, y1 in says["walls"]]
    walls += [Wall(x, y, length, width, math.radians(turned)) for x, y, length, width, turned in says.get("boxes", [])]
    pillars = [Pillar(*one) for one in says.get("pillars", [])]
    x, y, degrees = says["start"]
    goals = tuple((float(one[0]), float(one[1])) for one in says["goals"])
    return World(path.stem, tuple(walls), tuple(pillars), (float(x), float(y), math.radians(degrees)), goals)


def line(x0: float, y0: float, x1: float, y1: float, thickness: float = THICKNESS) -> Wall:
    """A wall from one place to another, half its thickness longer at both ends, so that corners are closed."""
    length = math.hypot(x1 - x0, y1 - y0) + thickness
    heading = math.atan2(y1 - y0, x1 - x0)
    return Wall((x0 + x1) / 2, (y0 + y1) / 2, length, thickness, heading)
