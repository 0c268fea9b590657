"""The turtles live in a notebook: their field as they move, with buttons and keys to drive one of them."""

from __future__ import annotations

import base64
import io
import itertools
import math
import time
from pathlib import Path
from typing import Any

import numpy as np
from anywidget import AnyWidget
from PIL import Image
from std_srvs.srv import Empty
from traitlets import Dict, Unicode
from turtlesim.srv import Spawn, TeleportAbsolute

from course_kit.base.arguments import NAMESPACE, NODE, takes
from course_kit.lab.background import running
from course_kit.robots.turtlesim import picture, teleop
from course_kit.robots.turtlesim.field import Color
from course_kit.robots.turtlesim.seen_field import Move, Others, Repainted
from course_kit.robots.turtlesim.teleop import Teleop
from course_kit.robots.turtlesim.turtle import TICK
from course_kit.ros.spinning.nodes import WITHOUT_DESCRIPTIONS
from course_kit.views.live.life import stop_all
from course_kit.views.live.shown import Bundle
from course_kit.views.live.turtle_topics import TurtleTopics
from course_kit.views.live.view import View

POLL = TICK / 4  # seconds between two looks at what has come
FRAME = 0.75 * TICK  # the least time between two messages to the browser: one a tick, with all turtles in it
LOOK, SOONER = 0.3, 0.05  # seconds between two looks for turtles that came or went
RESTED, SOON = 1.0, 2.0  # seconds that turtles rest before a still is taken, and between two such
RARELY = 30.0  # seconds between two stills while turtles move: each takes as long as some frames
DRIVEN = [key for key in teleop.KEYS if key != "q"]  # the panel ends with close()
HERE = Path(__file__).parent


class TurtleWidget(AnyWidget):
    """What the browser shows: turtle.js."""

    _esm = Unicode(HERE.joinpath("turtle.js").read_text("utf-8")).tag(sync=True)
    _css = Unicode(HERE.joinpath("turtle.css").read_text("utf-8")).tag(sync=True)
    turtle = Unicode().tag(sync=True)
    topic = Unicode().tag(sync=True)
    first = Dict().tag(sync=True)  # the field until the browser has been sent all of it


class TurtlePanel(View):
    """A live field with its turtles, arrow buttons, and keys that work anywhere in it."""

    kind = "turtles"

    def __init__(self, turtle: str, namespace: str) -> None:
        self._turtle = turtle
        # A node for each turtle, so that panels of two do not take it from each other.
        name = "teleop_turtle" if turtle == "turtle1" else f"teleop_{turtle.replace('/', '_')}"
        self._topics = TurtleTopics(turtle, namespace)
        self._topics.on_silence = self._say
        self.topic = self._topics.pose_topic(turtle)
        self.teleop = running.run(
            Teleop, turtle, name, namespace=namespace or None, parameter_overrides=WITHOUT_DESCRIPTIONS
        )
        self._teleop_name = self.teleop.get_fully_qualified_name()
        self._count = 0  # messages to the browser: it asks for the whole field when one is missing
        self._whole = False  # whether it has asked
        self._said = ""
        self._shown_at = self._looked_at = self._sent_at = 0.0
        self._widget = TurtleWidget(turtle=turtle, topic=self.topic, first=self._all())
        self._widget.on_msg(lambda _, content, __: self._on_message(content))
        self._open(FRAME, math.inf, self._widget)

    def press(self, key: str) -> None:
        """Do what a key does: up, down, left, right, or a letter of turtle_teleop_key."""
        self.teleop.press(key)

    def still(self) -> Bundle:
        """The field as it is now, as a picture and in words."""
        field = self._topics.field
        scene = field.scene()
        drawn = picture.draw(scene, field.background)
        as_wide_as_live = {"image/png": {"width": 400, "height": 400}}
        image = base64.b64encode(_png(drawn)).decode()
        return {"text/plain": picture.in_words(scene), "image/png": image, "metadata": as_wide_as_live}

    def _close(self) -> None:
        self._topics.close()
        running.stop(self.teleop)

    # To the browser, in the view's thread.

    def _show(self) -> float:
        now = time.monotonic()
        if now - self._shown_at > 1.0:  # nobody looked meanwhile
            self._whole = True
        self._shown_at = now
        self._follow(now)
        if now - self._sent_at >= FRAME and (self._whole or self._topics.field.changes):
            self._sent_at = now
            self._send_changes()
        self._keep(SOON if now - self._sent_at > RESTED else RARELY)
        return POLL

    def _unseen(self) -> float:
        self._follow(time.monotonic())
        self._topics.field.changes.clear()
        return super()._unseen()

    def _follow(self, now: float) -> None:
        """Have happen on the field what has happened to the turtles."""
        if now - self._looked_at >= (SOONER if self._topics.misses_poses else LOOK):
            self._looked_at = now
            self._topics.look()
        self._topics.take()

    def _send_changes(self) -> None:
        """Tell the browser what is new."""
        changes, self._topics.field.changes = self._topics.field.changes, []
        if self._whole or any(isinstance(change, Repainted) for change in changes):
            self._whole = False
            trails = self._topics.field.scene().trails
            self._send(self._all(), _png(trails), _png(picture.shells()))
            return
        for kind, some in itertools.groupby(changes, type):
            if kind is Move:
                self._send({"kind": "moves"}, np.array(list(some), np.float32).tobytes())
            else:
                for change in some:
                    if isinstance(change, Others):
                        self._send({"kind": "turtles", **_roster(change)})

    def _send(self, content: dict[str, Any], *buffers: bytes) -> None:
        self._count += 1
        self._widget.send({**content, "count": self._count}, list(buffers))

    def _all(self) -> dict[str, Any]:
        """All that there is, but the trails."""
        return {"kind": "field", "count": self._count, **_roster(self._topics.field.everything())}

    def _say(self, text: str) -> None:
        if text != self._said:
            self._said = text
            self._widget.send({"kind": "said", "text": text})

    # From the browser, in the kernel's main thread.

    def _on_message(self, message: dict[str, Any]) -> None:
        kind = message.get("kind")
        self._say("")
        if kind == "show":
            self._whole = True
        elif kind == "key" and message["key"] in DRIVEN:
            self._on_key(message["key"])
        elif kind == "call" and message["service"] in ("clear", "reset"):
            self._ask(Empty, message["service"])
        elif kind == "spawn":
            self._ask(Spawn, kind, x=float(message["x"]), y=float(message["y"]))
        elif kind == "teleport":
            turtle = self._topics.field.turtles.get(self._turtle)
            theta = turtle.pose[2] if turtle and turtle.pose and turtle.is_somewhere else 0.0
            where = {"x": float(message["x"]), "y": float(message["y"]), "theta": theta}
            self._ask(TeleportAbsolute, f"{self._turtle}/teleport_absolute", **where)

    def _on_key(self, key: str) -> None:
        try:
            self.press(key)
        except Exception:  # rclpy's InvalidHandle: the node is gone
            name = self._teleop_name
            self._say(f"Keys do nothing: the node {name}, which sends them, was stopped. Run the panel's cell again.")

    def _ask(self, service_type: Any, service: str, **request: Any) -> None:
        self._topics.ask(service_type, self._topics.absolute(service), lambda _: None, **request)


def _roster(seen: Others) -> dict[str, Any]:
    """Who is there, as JSON has it: it has no NaN."""
    turtles = []
    for turtle in seen.turtles:
        told = {"number": turtle.number, "name": turtle.name, "shell": turtle.shell}
        pen = {"color": _css(turtle.pen.color), "width": turtle.pen.width, "down": turtle.pen.down}
        place = dict(zip(("x", "y", "theta"), turtle.pose, strict=True)) if turtle.pose and turtle.is_somewhere else {}
        turtles.append(told | pen | place)
    return {"turtles": turtles, "background": _css(seen.background), "wiped": seen.wiped}


def _css(color: Color) -> str:
    return f"rgb({color[0]}, {color[1]}, {color[2]})"


def _png(drawn: Image.Image) -> bytes:
    png = io.BytesIO()
    drawn.save(png, "PNG", compress_level=1)
    return png.getvalue()


@takes(turtle=NODE, namespace=NAMESPACE)
def drive(turtle: str = "turtle1", namespace: str = "") -> TurtlePanel:
    """Show the turtles of a simulator live and drive one of them: with the buttons, or with the keys of teleop.

    Arrow keys and g t r e d c v b f work anywhere in the panel. It follows turtles that are spawned or killed later, in
    whatever process the simulator runs. Of ROS's own turtlesim it cannot know a pen's width, takes its colour from what
    the sensor sees where the turtle rests, and misses trails from before. It ends with .close() or its cell's next run.
    Stands for `ros2 run turtlesim turtle_teleop_key` and the simulator's window.
    """
    panel_of = f"/{namespace.strip('/')}/{turtle}/pose".replace("//", "/")
    stop_all(lambda other: isinstance(other, TurtlePanel) and other.topic == panel_of)
    return TurtlePanel(turtle, namespace)
