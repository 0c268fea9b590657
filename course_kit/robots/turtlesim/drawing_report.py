"""Reports the drawing on hidden names: the original's topics have poses, but no pens and no wiped trails.

Whoever draws the field elsewhere listens to the topic `_drawing`, and asks the service `_trails` for what was drawn
before. Both are beside those of the original and are no part of what programs may count on.
"""

from __future__ import annotations

import base64
import io
import json
from dataclasses import astuple
from typing import TYPE_CHECKING

from example_interfaces.srv import Trigger
from PIL import Image
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

from course_kit.robots.turtlesim.turtle import Pen
from course_kit.robots.turtlesim.world import Drawer, Drawing, World

if TYPE_CHECKING:
    from course_kit.robots.turtlesim.node import TurtleSim

TOPIC, SERVICE = "_drawing", "_trails"
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class DrawingReport:
    """The hidden topic and service of a simulator."""

    def __init__(self, node: TurtleSim, world: World) -> None:
        self._world = world
        self._told: Drawing | None = None
        self._publisher = node.create_publisher(String, TOPIC, LATCHED)
        node.create_service(Trigger, SERVICE, self._on_trails)

    def settle(self) -> None:
        """Tell what has changed, if anything has."""
        now = self._world.drawing()
        if now != self._told:
            self._told = now
            self._publisher.publish(String(data=drawing_text(now)))

    def _on_trails(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        response.success, response.message = True, trails_text(self._world.trails())
        return response


def drawing_text(drawing: Drawing) -> str:
    """A drawing as JSON."""
    turtles = {name: (*drawer[:2], astuple(drawer.pen)) for name, drawer in drawing.turtles.items()}
    return json.dumps({"wiped": drawing.wiped, "turtles": turtles})


def drawing_of(text: str) -> Drawing:
    """The drawing that a text tells."""
    told = json.loads(text)
    turtles = {
        name: Drawer(number, shell, Pen(tuple(color), width, down))
        for name, (number, shell, (color, width, down)) in told["turtles"].items()
    }
    return Drawing(told["wiped"], turtles)


def trails_text(trails: Image.Image) -> str:
    """A picture as the base64 of a PNG."""
    png = io.BytesIO()
    trails.save(png, "PNG", compress_level=1)  # the turtles stand still meanwhile
    return base64.b64encode(png.getvalue()).decode()


def trails_of(text: str) -> Image.Image:
    """The picture that a text tells."""
    return Image.open(io.BytesIO(base64.b64decode(text))).convert("RGBA")
