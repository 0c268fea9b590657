"""One turtle: where it is, how it moves in a tick, its pen, the heading it turns to. No ROS."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum
from typing import NamedTuple

from course_kit.robots.turtlesim.field import EXTENT, Color, Field, Point, float32

TICK = 0.016  # seconds; fixed, never measured
COMMAND_LIFETIME = 1_000_000_000  # nanoseconds that a velocity command holds
ARRIVED = 0.02  # radians from the goal at which a rotation ends
ROTATION_SPEED = 1.0  # radians a second


def normalise(angle: float) -> float:
    """The same direction as `angle` (radians), in [-pi, pi)."""
    rest = math.remainder(angle, math.tau)
    return -math.pi if rest >= math.pi else rest


class TurtleLogLine(NamedTuple):
    """A line for the node's log: "info", "warn" or "error", and the text."""

    level: str
    text: str


class Pose(NamedTuple):
    """The fields of turtlesim/msg/Pose, as float32 holds them: metres, radians, and those a second."""

    x: float
    y: float
    theta: float
    linear_velocity: float
    angular_velocity: float


class Outcome(Enum):
    """How a rotation ended."""

    SUCCEEDED = "succeeded"
    CANCELED = "canceled"
    ABORTED = "aborted"


@dataclass(eq=False)
class Rotation:
    """A heading that a turtle turns to. Set `canceling` to have the next tick cancel it."""

    goal: float  # radians
    start: float  # radians: the turtle's heading when the goal came
    delta: float = 0.0  # radians: the result so far; its sign is opposite to the turn
    canceling: bool = False
    outcome: Outcome | None = None  # None while it runs


@dataclass
class Pen:
    """What a turtle draws with: colour, width in pixels, and whether it is down."""

    color: Color = (179, 184, 255)
    width: int = 3
    down: bool = True


class Reading(NamedTuple):
    """What one tick tells about a turtle: for its pose, its colour sensor and its rotation's feedback."""

    pose: Pose
    color: Color
    remaining: float | None  # radians still to turn; None without a rotation


class Teleport(NamedTuple):
    """A jump that waits for the next tick; a relative one turns by `theta` and then goes `x` forward."""

    x: float
    y: float
    theta: float
    relative: bool


@dataclass(eq=False)
class Turtle:
    """A turtle at `x`, `depth` metres from the top left corner; times are nanoseconds of any steady clock."""

    name: str
    x: float
    depth: float
    theta: float
    last_command: int
    shell: int = 0  # which turtle of its world, counted from 0: for its colour in the picture
    number: int = 0  # of all turtles ever made
    pen: Pen = field(default_factory=Pen)
    rotation: Rotation | None = None
    teleports: list[Teleport] = field(default_factory=list)
    forward: float = 0.0  # metres a second, along its heading
    sideways: float = 0.0  # metres a second, to its left
    turning: float = 0.0  # radians a second, counter-clockwise

    @property
    def point(self) -> Point:
        """Where it is on the field."""
        return self.x, self.depth

    def stop(self) -> None:
        """Let every velocity be 0."""
        self.forward = self.sideways = self.turning = 0.0

    def end_rotation(self, outcome: Outcome) -> None:
        """End the rotation that runs, if any."""
        if self.rotation is not None:
            self.rotation.outcome = outcome
            self.rotation = None

    def tick(self, now: int, ground: Field, log: list[TurtleLogLine]) -> Reading:
        """Move for one tick and draw; append to `log` what is to be said."""
        for teleport in self.teleports:
            self._jump(teleport, ground)
        self.teleports.clear()
        remaining = self._rotate(now, log)
        if now - self.last_command > COMMAND_LIFETIME:
            self.stop()
        old = self.point
        self._move()
        self._stay_inside(log)
        speed = math.hypot(self.forward, self.sideways)
        values = (self.x, EXTENT - self.depth, self.theta, speed, self.turning)
        reading = Reading(Pose(*map(float32, values)), ground.color_at(self.point), remaining)
        if self.point != old:
            self._draw(old, ground)
        return reading

    def _jump(self, to: Teleport, ground: Field) -> None:
        old = self.point
        if to.relative:
            self.theta += to.theta
            self.x += math.cos(self.theta) * to.x
            self.depth -= math.sin(self.theta) * to.x
        else:
            self.x, self.depth, self.theta = to.x, max(0.0, EXTENT - to.y), to.theta
        self._draw(old, ground)

    def _rotate(self, now: int, log: list[TurtleLogLine]) -> float | None:
        """Turn towards the rotation's goal, or end it; return the radians still to turn."""
        rotation = self.rotation
        if rotation is None:
            return None
        if rotation.canceling:
            log.append(TurtleLogLine("info", "Rotation goal canceled"))
            self.end_rotation(Outcome.CANCELED)
            self.stop()
            return None
        # Headings in float32 as the original's, so that its numbers come out to the last digit.
        remaining = normalise(normalise(rotation.goal) - float32(self.theta))
        rotation.delta = float32(normalise(float32(rotation.start - self.theta)))
        self.stop()
        if abs(remaining) < ARRIVED:
            log.append(TurtleLogLine("info", "Rotation goal completed successfully"))
            self.end_rotation(Outcome.SUCCEEDED)
        else:
            self.turning = -ROTATION_SPEED if remaining < 0 else ROTATION_SPEED
            self.last_command = now
        return float32(remaining)

    def _move(self) -> None:
        self.theta = normalise(self.theta + self.turning * TICK)
        cosine, sine = math.cos(self.theta), math.sin(self.theta)
        self.x += (cosine * self.forward - sine * self.sideways) * TICK
        self.depth -= (sine * self.forward + cosine * self.sideways) * TICK

    def _stay_inside(self, log: list[TurtleLogLine]) -> None:
        if 0 <= self.x <= EXTENT and 0 <= self.depth <= EXTENT:
            return
        log.append(TurtleLogLine("warn", f"Oh no! I hit the wall! (Clamping from [x={self.x:f}, y={self.depth:f}])"))
        self.x = min(max(self.x, 0.0), EXTENT)
        self.depth = min(max(self.depth, 0.0), EXTENT)

    def _draw(self, start: Point, ground: Field) -> None:
        if self.pen.down:
            ground.draw_line(start, self.point, self.pen.color, self.pen.width)
