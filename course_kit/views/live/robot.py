"""A robot live in a notebook, from above: where it is, what its laser sees, its map, its plan, and goals by click."""

from __future__ import annotations

import base64
import io
import math
import time
from collections import deque
from pathlib import Path
from typing import TYPE_CHECKING, Any

from anywidget import AnyWidget
from rclpy.exceptions import InvalidHandle
from rclpy.node import Node
from traitlets import Dict, Unicode

from course_kit.base.arguments import NAMESPACE, Rule, takes
from course_kit.robots.robot import picture, shape
from course_kit.robots.robot.picture import Color, Seen
from course_kit.views.live.life import stop_all
from course_kit.views.live.robot_layers import Layer, Layers
from course_kit.views.live.shown import Bundle
from course_kit.views.live.view import View
from course_kit.views.live.watched_robot import WatchedRobot

if TYPE_CHECKING:
    from course_kit.robots.robot.simulation import Simulation

FRAME = 1 / 12  # s between two messages to the browser
TOLD = 0.25  # s between two texts with numbers
PACE = 2.0  # s over which it is measured how fast simulated time goes
RESTED, SOON, RARELY = 1.0, 2.0, 30.0  # s that robots rest before a still is taken; between two; while they move
HERE = Path(__file__)


def _runs(node: Any) -> bool:
    return hasattr(node, "simulation") and node.vehicle in node.simulation.vehicles()


ROBOT = Rule(
    "a Robot that runs, or the namespace of one",
    "'/robot2'",
    (str, Node),
    lambda value: NAMESPACE.fits(value) if isinstance(value, str) else _runs(value),
)


def _css(color: Color) -> str:
    return f"rgb({color[0]}, {color[1]}, {color[2]})"


LOOKS: dict[str, Any] = {
    "radius": shape.RADIUS,
    "wheels": [shape.WHEEL_RADIUS, shape.WHEEL_SEPARATION],
    "bodies": [_css(color) for color in picture.BODIES],
    "floor": _css(picture.FLOOR),
    "outside": _css(picture.OUTSIDE),
    "wall": _css(picture.WALL),
    "hits": _css(picture.HIT),
    "path": _css(picture.PATH),
    "goal": _css(picture.GOAL),
    "estimate": _css(picture.ESTIMATE),
    "particles": _css(picture.PARTICLE),
}


class RobotWidget(AnyWidget):
    """What the browser shows: robot.js."""

    # As texts: of files, anywidget keeps every widget for ever, to tell it when they change.
    _esm = Unicode(HERE.with_suffix(".js").read_text("utf-8")).tag(sync=True)
    _css = Unicode(HERE.with_suffix(".css").read_text("utf-8")).tag(sync=True)
    look = Dict(LOOKS).tag(sync=True)  # colours and sizes, those of the still
    goals = Unicode().tag(sync=True)  # the topic


class RobotView(View):
    """Robots from above, live, until stop(), the same view again, the next run of its cell or the end of ROS."""

    kind = "robot"

    def __init__(self, robots: tuple[Any, ...]) -> None:
        self._watched = [WatchedRobot(robot) for robot in robots]
        self.namespaces = [one.namespace for one in self._watched]
        self._simulation: Simulation | None = next((r.simulation for r in robots if not isinstance(r, str)), None)
        self._world = None if self._simulation is None else self._simulation.world
        self._there: list[tuple[WatchedRobot, Seen]] = []
        self._others: list[Seen] = []  # robots of the same world that nobody has asked for
        self._layers = Layers()
        self._whole = True  # whether a browser has asked for all there is
        self._count = 0  # messages to the browser: it asks for all when one is missing
        self._text = ""
        self._paces: deque[tuple[float, float]] = deque()  # real and simulated time, s
        self._shown_at = self._told_at = self._moved_at = 0.0
        self._follow()
        self._widget = RobotWidget(goals=self._watched[0].topics.goals)
        self._widget.on_msg(lambda _, content, __: self._on_message(content))
        self._open(FRAME, math.inf, self._widget)

    def still(self) -> Bundle:
        """The world with the robots as they are now, as a picture and in words."""
        drawn = picture.draw(self._world, self._seen())
        png = io.BytesIO()
        drawn.save(png, "PNG")
        return {
            "text/plain": drawn.info["Description"],
            "image/png": base64.b64encode(png.getvalue()).decode(),
            "metadata": {"image/png": {"width": drawn.width, "height": drawn.height}},
        }

    def _close(self) -> None:
        for one in self._watched:
            one.topics.close()

    def _end(self, error: Exception | None) -> None:
        is_over = isinstance(error, InvalidHandle) or not self._watched[0].topics.is_open
        super()._end(None if is_over else error)  # ROS was shut down: the last picture stays

    # To the browser, in the view's thread.

    def _show(self) -> float:
        now = time.monotonic()
        if self._whole or now - self._shown_at > 1.0:  # nobody looked meanwhile
            self._whole = False
            self._layers.forget()
        self._shown_at = now
        self._follow()
        if now - self._told_at >= TOLD:
            self._told_at, self._text = now, self._in_numbers(now)
        trails = [one.trail for one, _ in self._there]
        if news := self._layers.news(self._world, self._seen(), trails, text=self._text):
            self._send(news)
        if any(layer.told["layer"] in ("robots", "map") for layer in news):
            self._moved_at = now
        self._keep(SOON if now - self._moved_at > RESTED else RARELY)
        return FRAME

    def _unseen(self) -> float:
        self._follow()
        return super()._unseen()

    def _follow(self) -> None:
        """Have the robots be where they are now."""
        places = {} if self._simulation is None else self._simulation.true_places()
        self._there = [(one, seen) for one in self._watched if (seen := one.look(places)) is not None]
        unasked = places.keys() - {one.number for one in self._watched}
        self._others = [Seen(places[number], name=f"robot {number}") for number in sorted(unasked)]

    def _seen(self) -> list[Seen]:
        return [*(seen for _, seen in self._there), *self._others]

    def _in_numbers(self, now: float) -> str:
        """What is said below the picture."""
        lines = [self._times(now)]
        there = {id(one): seen for one, seen in self._there}
        for one in self._watched:
            seen = there.get(id(one))
            lines += [one.absence()] if seen is None else [one.in_numbers(seen), *one.topics.robot.notes]
            lines += one.topics.refused
        return "\n".join(line for line in lines if line)

    def _times(self, now: float) -> str:
        simulated = self._watched[0].topics.time
        if simulated is None:
            return ""
        if self._paces and simulated < self._paces[-1][1]:  # another simulation
            self._paces.clear()
        self._paces.append((now, simulated))
        while now - self._paces[0][0] > PACE:
            self._paces.popleft()
        began, simulated_then = self._paces[0]
        pace = f", {(simulated - simulated_then) / (now - began):.1f} times real time" if now > began else ""
        return f"{simulated:.1f} s simulated{pace}"

    def _send(self, news: list[Layer]) -> None:
        self._count += 1
        layers = [{**layer.told, "has_data": bool(layer.data)} for layer in news]
        data = [layer.data for layer in news if layer.data]
        self._widget.send({"kind": "layers", "count": self._count, "layers": layers}, data)

    # From the browser, in the kernel's main thread.

    def _on_message(self, message: dict[str, Any]) -> None:
        if message.get("kind") == "show":
            self._whole = True
        elif message.get("kind") == "goal":
            self._widget.send({"kind": "said", "text": self._send_goal(message)})

    def _send_goal(self, message: dict[str, Any]) -> str:
        place = float(message["x"]), float(message["y"]), float(message["heading"])
        try:
            return self._watched[0].topics.send_goal(place)
        except Exception as error:  # rclpy's InvalidHandle: ROS was shut down
            return f"The goal was not sent: {error}. Run the view's cell again."


@takes(robots=ROBOT)
def show_robot(*robots: Any) -> RobotView:
    """Show a robot from above, live: its laser, path, plan, map and estimate, and set goals by a click.

    Takes nodes of Robot that run here, whose true place and world are drawn, or namespaces of robots wherever they run,
    of which what their topics tell is drawn: odom, scan, map, plan, goal_pose, amcl_pose, particle_cloud, /tf, /clock.
    Without any, the robot without a namespace. A click publishes goal_pose, a drag turns it; arrow keys and Enter do
    the same. It ends with .stop(), the next run of its cell, or when the same is shown again. Stands for rviz2.
    """
    simulations = {id(one.simulation) for one in robots if not isinstance(one, str)}
    if len(simulations) > 1:
        raise ValueError("show_robot(): robots of two worlds are in no one picture. Show each in a cell of its own")
    wanted = [one if isinstance(one, str) else one.get_namespace() for one in robots or ("",)]
    stop_all(lambda other: isinstance(other, RobotView) and other.namespaces == wanted)
    return RobotView(robots or ("",))
