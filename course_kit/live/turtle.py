"""The turtle live in a notebook: its field as it moves, with arrow buttons and keys to drive it."""

from __future__ import annotations

import html
import itertools
from collections import deque
from typing import Any

import numpy as np
from ipycanvas import MultiCanvas, hold_canvas
from ipywidgets import HTML, Button, GridBox, HBox, Layout, VBox
from rclpy.serialization import deserialize_message
from turtlesim.msg import Pose

from course_kit.background import running
from course_kit.live.life import Life, stop_all
from course_kit.text import stands_still
from course_kit.turtlesim import Teleop, teleop
from course_kit.turtlesim.field import METER, SIZE
from course_kit.turtlesim.picture import turtle_image
from course_kit.watching import instruments

SCREEN = 400  # pixels; the field's 500 shrink to it in the browser
FRAME = 0.05  # seconds between two pictures
BACKGROUND = "rgb(69, 86, 255)"
TRAIL = "rgb(179, 184, 255)"
# A longer step between two poses is a teleport of a reset, and no trail.
STEP = 3.0
KEYS = {"ArrowUp": "up", "ArrowDown": "down", "ArrowLeft": "left", "ArrowRight": "right"}
DRIVEN = [key for key in teleop.KEYS if key != "q"]  # the panel ends with close()
BUTTONS = {"up": "arrow-up", "left": "arrow-left", "down": "arrow-down", "right": "arrow-right"}


class TurtlePanel(Life, VBox):
    """A live field with a turtle on it, arrow buttons, and keys once the field was clicked."""

    def __init__(self, turtle: str, namespace: str) -> None:
        self.topic = _topic(turtle, namespace)
        options: dict[str, Any] = {"namespace": namespace} if namespace else {}
        if turtle != "turtle1":  # the teleop node's own name for its turtle, as in the original
            remapping = [f"turtle1/{topic}:={turtle}/{topic}" for topic in ("cmd_vel", "rotate_absolute")]
            options["cli_args"] = ["--ros-args", *(word for rule in remapping for word in ("-r", rule))]
        self.teleop = running.run(Teleop, **options)
        self._poses: deque[bytes] = deque(maxlen=1000)
        self._last: Pose | None = None
        self._canvas = MultiCanvas(2, width=SIZE, height=SIZE, layout=Layout(width=f"{SCREEN}px", height=f"{SCREEN}px"))
        self._canvas[0].fill_style, self._canvas[0].stroke_style = BACKGROUND, TRAIL
        self._canvas[0].line_width = 3
        self._canvas[0].fill_rect(0, 0, SIZE, SIZE)
        self._canvas.on_key_down(self._on_key)
        self._line = HTML()
        super().__init__([HBox([self._canvas, self._pad()]), self._line])
        self._subscription = instruments.subscribe(self.topic, self._on_pose, "turtlesim/msg/Pose")
        self._begin(f"view of {self.topic}", FRAME)

    def press(self, key: str) -> None:
        """Do what a key does: up, down, left, right, or a letter of turtle_teleop_key."""
        self.teleop.press(key)

    def _end(self, error: Exception | None) -> None:
        self._subscription.close()
        running.stop(self.teleop)
        if error is not None:
            self._line.value = f"<code>{html.escape(stands_still('The picture', error))}</code>"

    def _pad(self) -> GridBox:
        """The arrow buttons, laid out as the keys are."""
        buttons = []
        for key, icon in BUTTONS.items():
            button = Button(icon=icon, tooltip=key, layout=Layout(width="44px", height="36px", grid_area=key))
            button.on_click(lambda _, key=key: self.press(key))
            buttons.append(button)
        areas = "'. up .' 'left down right'"
        layout = Layout(grid_template_areas=areas, grid_gap="4px", margin="0 0 0 12px", align_content="center")
        return GridBox(buttons, layout=layout)

    def _on_key(self, key: str, *_modifiers: bool) -> None:
        if (pressed := KEYS.get(key, key)) in DRIVEN:
            self.press(pressed)

    def _on_pose(self, serialised: bytes, *_info: Any) -> None:
        self._poses.append(serialised)

    def _show(self) -> float:
        if self._poses:
            self._draw([deserialize_message(self._poses.popleft(), Pose) for _ in range(len(self._poses))])
        return FRAME

    def _draw(self, poses: list[Pose]) -> None:
        """Add the way since the last picture to the trail and put the turtle at its end."""
        newest, known = poses[-1], [*([self._last] if self._last else []), *poses]
        if newest == self._last:
            return
        self._last = newest
        points = list(dict.fromkeys(_pixel(pose) for pose in known))
        sprite = np.array(turtle_image(0, round(np.degrees(newest.theta)) % 360))
        trail, turtle = self._canvas[0], self._canvas[1]
        with hold_canvas():
            for (x0, y0), (x1, y1) in itertools.pairwise(points):
                if abs(x1 - x0) + abs(y1 - y0) < STEP * METER:
                    trail.stroke_line(x0, y0, x1, y1)
            turtle.clear()
            x, y = points[-1]
            turtle.put_image_data(sprite, x - sprite.shape[1] / 2, y - sprite.shape[0] / 2)
        self._line.value = f"<code>x {newest.x:.2f} m, y {newest.y:.2f} m, heading {newest.theta:.2f} rad</code>"


def _pixel(pose: Pose) -> tuple[float, float]:
    return pose.x * METER, SIZE - 1 - pose.y * METER


def drive(turtle: str = "turtle1", namespace: str = "") -> TurtlePanel:
    """Show a turtle live and drive it: with the buttons, or with the arrow keys after a click on the field.

    Stands for `ros2 run turtlesim turtle_teleop_key` and the simulator's window.
    """
    topic = _topic(turtle, namespace)
    stop_all(lambda other: isinstance(other, TurtlePanel) and other.topic == topic)
    return TurtlePanel(turtle, namespace)


def _topic(turtle: str, namespace: str) -> str:
    return "/" + "/".join(part for part in (namespace.strip("/"), turtle, "pose") if part)
