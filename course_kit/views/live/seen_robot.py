"""A robot as its own messages tell of it, in one picture: where it is, what its laser has hit, its map. No ROS."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from course_kit.robots.navigation.places import after, between, inverse, moved
from course_kit.robots.robot.picture import Cells, Seen
from course_kit.robots.robot.world import Place
from course_kit.views.live.robot_frames import HERE, Frames

Floats = npt.NDArray[np.float64]
STEP, JUMP = 0.02, 0.5  # m: a step of the path driven, and what is none but a jump
LONGEST = 4000  # steps of it
RIGHT = 0.3  # m: a good estimate is as near as this to where the robot is
OLD = 2.0  # s: a scan from so long ago is not shown any more


_versions = itertools.count()


class Trail:
    """The path driven, in steps. Where `version` is the same as before, only the last ones are new."""

    def __init__(self) -> None:
        self.replace([])

    def go(self, place: Place) -> None:
        """The robot is here now; what leads over a jump was not driven."""
        here = place[:2]
        way = math.dist(self.steps[-1], here) if self.steps else math.inf
        if way > JUMP:
            self.replace([])
        if way > STEP:
            self.steps.append(here)
        if len(self.steps) > LONGEST:
            self.replace(self.steps[::2])

    def replace(self, steps: list[tuple[float, float]]) -> None:
        """Have other steps in their stead."""
        self.steps, self.version = steps, next(_versions)


class SeenRobot:
    """One robot; the picture's frame is the world's, if that is known, else the outermost that transforms lead to."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.frames = Frames()
        self.frame = ""  # the outermost of its own frames: map, or odom
        self.trail = Trail()
        self.notes: list[str] = []  # what is not drawn, and why; anew with each seen()
        self._odom = self._base = ""  # frames
        self._time = 0.0  # of its odometry, s
        self._place: Place | None = None  # in the picture
        self._believed: Place | None = None  # the same as its transforms tell
        self._is_true = False  # whether its place is the true one
        self._origin = HERE  # of its outermost frame, in the picture
        self._start: Place | None = None  # of its odometry, in the world
        self._is_placed = False  # whether its outermost frame is where it should be in the world
        self._scan: tuple[str, float, Floats] | None = None
        self._layers: dict[str, tuple[str, Any]] = {}  # what lies in a frame: that, and itself

    # What it tells.

    def drive(self, odom: str, base: str, place: Place, time: float) -> None:
        """Its odometry says that the frame `base` is here in the frame `odom`, at a time (s)."""
        self._odom, self._base, self._time = odom, base, time
        self.frames.add(odom, base, place, time)

    def scan(self, frame: str, time: float, hits: Floats) -> None:
        """Its laser has hit something there, points (n, 2) in a frame."""
        self._scan = frame, time, hits

    def lay(self, kind: str, frame: str, layer: Any) -> None:
        """Its map, plan (n, 2), goal, estimate or particles (n, 3) are these, in a frame; the last one counts."""
        self._layers[kind] = frame, layer

    # What it means.

    def look(self, truth: Place | None = None) -> None:
        """Take in where it is now; `truth` is where in the world, if that is known."""
        if self._base:
            self._find_frame(truth)
            believed = self.frames.find(self._base, self.frame) or HERE
            if truth is not None:
                self._place_frame(truth, believed)
            self._believed = after(self._origin, believed)
        self._place, self._is_true = truth or self._believed, truth is not None
        if self._place is not None:
            self.trail.go(self._place)

    def _find_frame(self, truth: Place | None) -> None:
        before, self.frame = self.frame, self.frames.root(self._odom)
        if before in ("", self.frame):
            return
        self._is_placed = False
        shift = self.frames.find(before, self.frame)
        if truth is None and shift and self.trail.steps:
            self.trail.replace([(x, y) for x, y in moved(np.array(self.trail.steps), shift)])

    def _place_frame(self, truth: Place, believed: Place) -> None:
        """Find where in the world its outermost frame is.

        A map's is where the world's is, if it was made of the world, or where the robot was when it began to map it:
        what puts the robot nearer to where it is. Once that is good it stays, however far the estimate drifts then.
        """
        if self._start is None:
            self._start = after(truth, inverse(self.frames.find(self._base, self._odom) or HERE))
        if self._is_placed:
            return
        choices = [self._start] if self.frame == self._odom else [HERE, self._start]
        distances = [math.dist(after(one, believed)[:2], truth[:2]) for one in choices]
        self._origin = choices[int(np.argmin(distances))]
        self._is_placed = min(distances) < RIGHT

    def named(self, place: Place) -> Place:
        """A place of the picture in the robot's outermost frame, as a goal names it."""
        return between(self._origin, place)

    def seen(self) -> Seen | None:
        """All of it in the picture's frame; None before anything has said where it is."""
        self.notes = []
        if self._place is None:
            return None
        estimate = self._moved_place("estimate")
        if self._is_true and (self.frame != self._odom or estimate is None):
            estimate = self._believed  # which is newer than what a localizer says after each of its steps
        particles, plan, cells = (self._layer(kind) for kind in ("particles", "plan", "map"))
        return Seen(
            self._place,
            hits=self._hits(),
            trail=self.trail.steps,
            path=moved(plan[1], plan[0]) if plan else (),
            goal=self._moved_place("goal"),
            cells=_placed(cells[1], cells[0]) if cells else None,
            name=self.name,
            estimate=estimate,
            particles=_turned(particles[1], particles[0]) if particles else (),
        )

    def _layer(self, kind: str) -> tuple[Place, Any] | None:
        """A layer with the place of its frame in the picture."""
        if kind not in self._layers:
            return None
        frame, layer = self._layers[kind]
        place = self.frames.find(frame or self.frame, self.frame)
        if place is None:
            self.notes.append(f"The {kind} is not drawn: {self._unknown(frame, self.frame)}.")
            return None
        return after(self._origin, place), layer

    def _moved_place(self, kind: str) -> Place | None:
        found = self._layer(kind)
        return found and after(*found)

    def _hits(self) -> Floats:
        """What the laser has hit: seen from where the robot was then."""
        if self._scan is None or self._place is None or not self._base or abs(self._time - self._scan[1]) > OLD:
            return np.empty((0, 2))
        frame, time, hits = self._scan
        laser = self.frames.find(frame, self._base)
        if laser is None:
            self.notes.append(f"The scan is not drawn: {self._unknown(frame, self._base)}.")
            return np.empty((0, 2))
        now, then = (self.frames.find(self._base, self._odom, at) or HERE for at in (None, time))
        return moved(hits, after(after(self._place, between(now, then)), laser))

    def _unknown(self, frame: str, outer: str) -> str:
        return f"it is in frame '{frame}', and no transform on /tf or /tf_static says where that is in '{outer}'"


def _placed(cells: Cells, by: Place) -> Cells:
    x, y, heading = after(by, (*cells.corner, cells.heading))
    return replace(cells, corner=(x, y), heading=heading)


def _turned(places: Floats, by: Place) -> Floats:
    return np.column_stack([moved(places[:, :2], by), places[:, 2] + by[2]])


def in_numbers(place: tuple[float, ...]) -> str:
    """A place as it is told."""
    x, y, heading = (round(part, 2) + 0.0 for part in place)
    return f"x {x:.2f} m, y {y:.2f} m, heading {heading:.2f} rad"
