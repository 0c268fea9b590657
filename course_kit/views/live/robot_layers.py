"""The layers of a world with robots that a browser draws, and which of them are new. No ROS, no Jupyter."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from course_kit.robots.robot import picture
from course_kit.robots.robot.picture import Cells, Points, Seen
from course_kit.robots.robot.world import Place, World
from course_kit.views.live.seen_robot import Trail

GRAIN = 1.0  # m: where nothing tells how large the world is, what is shown grows by so much


class Layer(NamedTuple):
    """One layer as it is sent: what can be JSON, and numbers or a picture beside it."""

    told: dict[str, Any]
    data: bytes = b""


@dataclass
class Layers:
    """What the browser has been told; news() is what it has not."""

    _sent: dict[str, Layer] = field(default_factory=dict)
    _steps: dict[str, tuple[int, int]] = field(default_factory=dict)  # of trails: version, and how many were sent
    _maps: dict[str, tuple[npt.NDArray[np.int8], bytes]] = field(default_factory=dict)
    _box: tuple[float, float, float, float] | None = None  # what is shown of an unknown world

    def forget(self) -> None:
        """The browser knows nothing."""
        self._sent.clear()
        self._steps.clear()

    def news(self, world: World | None, robots: Sequence[Seen], trails: Sequence[Trail], **told: Any) -> list[Layer]:
        """The layers that are new since the last call; `told` is sent beside them if it has changed."""
        found = {"ground": self._ground(world, robots), "robots": Layer({"robots": [_robot(one) for one in robots]})}
        for name, value in told.items():
            found[name] = Layer({name: value})
        for number, robot in enumerate(robots):
            points = {"hits": robot.hits, "path": robot.path, "particles": robot.particles}
            for kind, some in points.items():
                found[f"{kind} {number}"] = Layer({"robot": number}, _floats(some))
            found[f"map {number}"] = self._map(f"map {number}", robot.cells, number)
        news = {name: layer for name, layer in found.items() if layer != self._sent.get(name, Layer({}))}
        self._sent.update(news)
        new = [Layer({**layer.told, "layer": name.split()[0]}, layer.data) for name, layer in news.items()]
        return new + [layer for number, trail in enumerate(trails) for layer in self._new_steps(number, trail)]

    def _ground(self, world: World | None, robots: Sequence[Seen]) -> Layer:
        scale = picture.scale_of(world, robots)
        box = (scale.left, scale.top - scale.height / scale.meter, scale.left + scale.width / scale.meter, scale.top)
        if world is None:
            box = self._grown(box)
        told: dict[str, Any] = {"box": box, "walls": [], "pillars": []}
        if world is not None:
            told["walls"] = [picture.corners(wall) for wall in world.walls]
            told["pillars"] = [(one.x, one.y, one.radius) for one in world.pillars]
        return Layer(told)

    def _grown(self, box: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
        """What was shown and what must be, in whole steps: it shall not move with the robot."""
        low = np.floor(np.array(box[:2]) / GRAIN) * GRAIN
        high = np.ceil(np.array(box[2:]) / GRAIN) * GRAIN
        if self._box is not None:
            low, high = np.minimum(low, self._box[:2]), np.maximum(high, self._box[2:])
        self._box = (float(low[0]), float(low[1]), float(high[0]), float(high[1]))
        return self._box

    def _map(self, name: str, cells: Cells | None, number: int) -> Layer:
        if cells is None:
            return Layer({"robot": number, "place": None})
        values, png = self._maps.get(name, (None, b""))
        if values is not cells.values:
            drawn = io.BytesIO()
            picture.shades(cells).save(drawn, "PNG", compress_level=1)
            png = drawn.getvalue()
            self._maps[name] = cells.values, png
        place = (*cells.corner, cells.heading)
        return Layer({"robot": number, "place": place, "resolution": cells.resolution}, png)

    def _new_steps(self, number: int, trail: Trail) -> list[Layer]:
        version, count = self._steps.get(f"trail {number}", (-1, 0))
        begin = count if version == trail.version else 0
        self._steps[f"trail {number}"] = trail.version, len(trail.steps)
        if version == trail.version and begin == len(trail.steps):
            return []
        return [Layer({"layer": "trail", "robot": number, "from": begin}, _floats(trail.steps[begin:]))]


def _robot(robot: Seen) -> dict[str, Any]:
    return {
        "name": robot.name,
        "place": _rounded(robot.place),
        "estimate": _rounded(robot.estimate),
        "goal": _rounded(robot.goal),
    }


def _rounded(place: Place | tuple[float, ...] | None) -> list[float] | None:
    """As much of a place as can be seen: what stands still is not told again."""
    return None if place is None else [round(float(part), 3) for part in place]


def _floats(points: Points) -> bytes:
    return np.asarray(points, np.float32).tobytes()
