"""The field as somebody sees it who gets poses and pens from outside: who is there, what they have drawn. No ROS."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from PIL import Image

from course_kit.robots.turtlesim.field import BLANK, EXTENT, Color
from course_kit.robots.turtlesim.strokes import Stroke, Strokes
from course_kit.robots.turtlesim.turtle import Pen
from course_kit.robots.turtlesim.world import Drawing, Figure, Scene

BACKGROUND: Color = (69, 86, 255)


class Move(NamedTuple):
    """A turtle, by its number, is now at x, y (metres) with a heading (radians)."""

    number: int
    x: float
    y: float
    theta: float


class Repainted(NamedTuple):
    """The trails are other ones than all that was told before makes."""


@dataclass
class SeenTurtle:
    """One turtle; its number is never another one's."""

    name: str
    number: int
    shell: int
    pen: Pen = field(default_factory=Pen)
    pose: tuple[float, float, float] | None = None  # metres, metres, radians
    rests: bool = False  # whether its last two poses are at one place
    felt: Color | None = None  # what its sensor said since it rests

    @property
    def is_somewhere(self) -> bool:
        """True if it has come, and to a place: a turtle that is sent to NaN is nowhere."""
        return self.pose is not None and all(map(math.isfinite, self.pose))


class Others(NamedTuple):
    """Turtles have come, gone or changed their pens, or the background has; perhaps the trails were wiped away."""

    turtles: tuple[SeenTurtle, ...]
    background: Color
    wiped: bool


class SeenField:
    """Turtles by name and their trails; `changes` are what happened since somebody emptied it, in order."""

    def __init__(self) -> None:
        self.turtles: dict[str, SeenTurtle] = {}
        self.background = BACKGROUND
        self.changes: list[Move | Others | Repainted] = []
        self._strokes = Strokes()
        self._drawing: Drawing | None = None
        self._given = 0  # numbers
        self.is_told = False  # whether the simulator itself says who draws with what

    # What is seen.

    def add(self, name: str) -> None:
        """A turtle is there, new also if one of its name was: no line leads from that one to it."""
        told = self._drawing.turtles.get(name) if self._drawing else None
        shell = told.shell if told else len([one for one in self.turtles if one != name])
        self.turtles[name] = SeenTurtle(name, self._given, shell, told.pen if told else Pen())
        self._given += 1
        self._note()

    def remove(self, name: str) -> None:
        """A turtle has gone; its trail stays."""
        if self.turtles.pop(name, None):
            self._note()

    def move(self, name: str, x: float, y: float, theta: float) -> None:
        """A turtle has come to a place, and has drawn a line to it if its pen was down."""
        turtle = self.turtles.get(name)
        if turtle is None:
            return
        turtle.rests = turtle.pose is not None and turtle.pose[:2] == (x, y)
        turtle.felt = turtle.felt if turtle.rests else None
        if turtle.pose == (x, y, theta):
            return
        before, was_somewhere = turtle.pose, turtle.is_somewhere
        turtle.pose = (x, y, theta)
        if before and was_somewhere and turtle.is_somewhere and before[:2] != (x, y):
            start, end = (before[0], EXTENT - before[1]), (x, EXTENT - y)
            self._strokes.draw(Stroke(name, start, end, turtle.pen, settled=self.is_told))
        self.changes.append(Move(turtle.number, x, y, theta))

    def tell(self, drawing: Drawing) -> None:
        """The simulator itself has said who is there, and draws with what."""
        before, self._drawing, self.is_told = self._drawing, drawing, True
        for name in self.turtles.keys() - drawing.turtles.keys():
            del self.turtles[name]
        for name, drawer in drawing.turtles.items():
            turtle = self.turtles.get(name)
            if turtle is None or (before and before.turtles.get(name, drawer).number != drawer.number):
                self.add(name)
            else:
                turtle.shell, turtle.pen = drawer.shell, drawer.pen
        wiped = before is not None and before.wiped != drawing.wiped
        if wiped:
            self._strokes.clear()
        self._note(wiped)

    def feel(self, name: str, color: Color) -> None:
        """A turtle's sensor has said what is under it: what is known of its pen, where the simulator says nothing.

        While it moves, that is its own line or another one; once it rests, the end of its own.
        """
        turtle = self.turtles.get(name)
        if self.is_told or turtle is None or not turtle.is_somewhere or not turtle.pose or not turtle.rests:
            return
        before, turtle.felt = turtle.felt, color
        if color == self._strokes.color_at((turtle.pose[0], EXTENT - turtle.pose[1])):
            self._strokes.settle(name)
            return
        is_bare = color == BLANK[:3]
        if is_bare and before not in (None, color):
            self.wipe()
            return
        turtle.pen = replace(turtle.pen, down=False) if is_bare else Pen(color, turtle.pen.width)
        self._note()
        if self._strokes.settle(name, turtle.pen):
            self.changes.append(Repainted())

    def wipe(self) -> None:
        """The trails were wiped away."""
        self._strokes.clear()
        self._note(wiped=True)

    def take_over(self, trails: Image.Image) -> None:
        """What was drawn before anybody looked: RGBA, 500 x 500, below what is drawn here."""
        self._strokes.put_below(trails)
        self.changes.append(Repainted())

    def paint(self, background: Color) -> None:
        """The background has another colour."""
        self.background = background
        self._note()

    def _note(self, wiped: bool = False) -> None:
        self.changes.append(self.everything(wiped))

    # What is shown.

    def everything(self, wiped: bool = False) -> Others:
        """All turtles as they are now, and the background."""
        return Others(tuple(replace(turtle) for turtle in self.turtles.values()), self.background, wiped)

    def scene(self) -> Scene:
        """What there is to draw."""
        there = [turtle for _, turtle in sorted(self.turtles.items()) if turtle.is_somewhere]
        figures = [Figure(t.name, t.pose[0], EXTENT - t.pose[1], t.pose[2], t.shell) for t in there if t.pose]
        return Scene(self._strokes.image, figures)
