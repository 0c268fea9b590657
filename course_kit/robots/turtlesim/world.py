"""The turtles' world, tick by tick: who lives there and what they are told. No ROS, no clock of its own."""

from __future__ import annotations

import math
import threading
from dataclasses import replace
from typing import NamedTuple

from PIL import Image

from course_kit.robots.turtlesim.field import EXTENT, MIDDLE, Color, Field, float32
from course_kit.robots.turtlesim.turtle import Outcome, Pen, Reading, Rotation, Teleport, Turtle, TurtleLogLine


class Figure(NamedTuple):
    """Where to draw a turtle: its name, metres from the top left corner, heading in radians, which shell it has."""

    name: str
    x: float
    depth: float
    theta: float
    shell: int


class Scene(NamedTuple):
    """The world at one moment: the trails (RGBA, 500 x 500) and the turtles on them, in name order."""

    trails: Image.Image
    figures: list[Figure]


class Drawer(NamedTuple):
    """Who draws: a number that no other turtle has, which shell, the pen."""

    number: int
    shell: int
    pen: Pen


class Drawing(NamedTuple):
    """What poses do not tell of the picture: a number that counts how often it was wiped, who draws with what."""

    wiped: int
    turtles: dict[str, Drawer]


class World:
    """A field with turtles; its methods may be called from any thread.

    `now` is nanoseconds of any steady clock. What is told to a turtle that is not there is ignored, as a
    message to a killed turtle is.
    """

    def __init__(self, now: int) -> None:
        self.turtles: dict[str, Turtle] = {}
        self._field = Field()
        self._log: list[TurtleLogLine] = []
        self._started = False
        self._counter = 0  # of names given
        self._shells = 0  # of turtles made since the last reset
        # Counted on for each turtle made and each time that the trails are wiped; no other world has the same.
        self._made = self._wiped = now
        self._lock = threading.RLock()
        self.spawn("", MIDDLE, MIDDLE, 0.0, now)

    @property
    def field(self) -> Field:
        """What the turtles draw on."""
        return self._field

    def take_log(self) -> list[TurtleLogLine]:
        """The log lines since the last call."""
        with self._lock:
            lines, self._log = self._log, []
        return lines

    def scene(self) -> Scene:
        """What there is to draw: a copy, to be used in any thread."""
        with self._lock:
            turtles = [(name, self.turtles[name]) for name in sorted(self.turtles)]
            figures = [Figure(name, one.x, one.depth, one.theta, one.shell) for name, one in turtles]
            return Scene(self._field.image.copy(), figures)

    def drawing(self) -> Drawing:
        """What changes the picture, and is not told by poses."""
        with self._lock:
            turtles = {n: Drawer(t.number, t.shell, replace(t.pen)) for n, t in self.turtles.items()}
            return Drawing(self._wiped, turtles)

    def trails(self) -> Image.Image:
        """The trails as they are now: RGBA, 500 x 500, a copy."""
        with self._lock:
            return self._field.image.copy()

    def tick(self, now: int) -> dict[str, Reading]:
        """Let 16 ms pass; return what each turtle publishes. The first tick only starts the clock."""
        with self._lock:
            if not self._started:
                self._started = True
                return {}
            return {n: self.turtles[n].tick(now, self._field, self._log) for n in sorted(self.turtles)}

    # Turtles come and go.

    def spawn(self, name: str, x: float, y: float, theta: float, now: int) -> str:
        """Add a turtle at x, y (metres) with heading theta (radians); return its name, or "" if it cannot be.

        An empty name asks for the next free of turtle1, turtle2, ...
        """
        with self._lock:
            if name in self.turtles:
                self._say("error", f"A turtle named [{name}] already exists")
                return ""
            x, y, theta = float32(x), float32(y), float32(theta)
            if not self._finite("spawn", x, y, theta):
                return ""
            name = name or self._free_name()
            depth = float32(EXTENT - y)  # in float32 as the original's
            self.turtles[name] = Turtle(name, x, depth, theta, last_command=now, shell=self._shells, number=self._made)
            self._shells += 1
            self._made += 1
            self._say("info", f"Spawning turtle [{name}] at x=[{x:f}], y=[{y:f}], theta=[{theta:f}]")
            return name

    def kill(self, name: str) -> bool:
        """Remove a turtle; its rotation is aborted. False if there is none of that name."""
        with self._lock:
            turtle = self.turtles.pop(name, None)
            if turtle is None:
                self._say("error", f"Tried to kill turtle [{name}], which does not exist")
                return False
            turtle.end_rotation(Outcome.ABORTED)
            return True

    def clear(self) -> None:
        """Wipe the trails away."""
        with self._lock:
            self._say("info", "Clearing turtlesim.")
            self._wipe()

    def reset(self, now: int) -> None:
        """Begin again with turtle1 in the middle of a blank field."""
        with self._lock:
            self._say("info", "Resetting turtlesim.")
            for turtle in self.turtles.values():
                turtle.end_rotation(Outcome.ABORTED)
            self.turtles.clear()
            self._counter = self._shells = 0
            self.spawn("", MIDDLE, MIDDLE, 0.0, now)
            self._wipe()

    def _wipe(self) -> None:
        self._field.clear()
        self._wiped += 1

    def _free_name(self) -> str:
        while True:
            self._counter += 1
            name = f"turtle{self._counter}"
            if name not in self.turtles:
                return name

    # Turtles are told what to do.

    def command(self, name: str, forward: float, sideways: float, turning: float, now: int) -> None:
        """Give a turtle a velocity (metres a second, radians a second) for the next second."""
        with self._lock:
            turtle = self.turtles.get(name)
            if turtle is None or not self._finite(f"cmd_vel of [{name}]", forward, sideways, turning):
                return
            if turtle.rotation is not None:
                self._say("warn", "Velocity command received during rotation goal. Aborting goal")
                turtle.end_rotation(Outcome.ABORTED)
            turtle.last_command = now
            turtle.forward, turtle.sideways, turtle.turning = forward, sideways, turning

    def rotate(self, name: str, goal: float) -> Rotation:
        """Have a turtle turn to a heading (radians); the rotation that is returned tells how it ended."""
        with self._lock:
            turtle, goal = self.turtles.get(name), float32(goal)
            if turtle is None or not self._finite(f"rotate_absolute of [{name}]", goal):
                return Rotation(goal, 0.0, outcome=Outcome.ABORTED)
            if turtle.rotation is not None:
                text = "Rotation goal received before a previous goal finished. Aborting previous goal"
                self._say("warn", text)
                turtle.end_rotation(Outcome.ABORTED)
            turtle.rotation = Rotation(goal, turtle.theta)
            return turtle.rotation

    def teleport_absolute(self, name: str, x: float, y: float, theta: float) -> None:
        """Put a turtle at x, y (metres) with heading theta (radians) at the next tick."""
        self._teleport(name, "teleport_absolute", x, y, theta, relative=False)

    def teleport_relative(self, name: str, linear: float, angular: float) -> None:
        """At the next tick turn a turtle by `angular` (radians), then put it `linear` metres forward."""
        self._teleport(name, "teleport_relative", linear, 0.0, angular, relative=True)

    def set_pen(self, name: str, color: Color, width: int, *, off: bool) -> None:
        """Lift a turtle's pen, or put it down with this colour (0 to 255 each) and width (pixels)."""
        with self._lock:
            turtle = self.turtles.get(name)
            if turtle is None:
                return
            if off:
                turtle.pen.down = False
            else:
                turtle.pen = Pen(color, max(width, 1))

    def _teleport(self, name: str, service: str, x: float, y: float, theta: float, *, relative: bool) -> None:
        with self._lock:
            turtle = self.turtles.get(name)
            x, y, theta = float32(x), float32(y), float32(theta)
            if turtle is not None and self._finite(f"{service} of [{name}]", x, y, theta):
                turtle.teleports.append(Teleport(x, y, theta, relative))

    # What is said.

    def _finite(self, what: str, *values: float) -> bool:
        # The original takes NaN, and its turtle is lost from then on.
        if all(map(math.isfinite, values)):
            return True
        self._say("error", f"Ignored {what}: its numbers must be finite, not {list(values)}")
        return False

    def _say(self, level: str, text: str) -> None:
        self._log.append(TurtleLogLine(level, text))
