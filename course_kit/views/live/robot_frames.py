"""Frames that lie in one another in the plane, now and a moment ago: what of tf2 is seen from above. No ROS."""

from __future__ import annotations

from collections import deque

from course_kit.robots.navigation.places import after, between
from course_kit.robots.robot.world import Place

HERE: Place = (0.0, 0.0, 0.0)
KEPT = 200  # transforms of a pair of frames: some seconds
BACK = 1.0  # s: a time so much before the last one is that of a simulation that begins anew


class Frames:
    """Where frames are in their parents."""

    def __init__(self) -> None:
        self._parents: dict[str, str] = {}
        self._places: dict[str, deque[tuple[float, Place]]] = {}  # by child: time in s, place in the parent

    def add(self, parent: str, child: str, place: Place, time: float) -> None:
        """Learn where a frame is at a time (s); what is older than what is known says nothing new."""
        known = self._places.setdefault(child, deque(maxlen=KEPT))
        if self._parents.get(child) != parent or (known and time < known[-1][0] - BACK):
            known.clear()
        self._parents[child] = parent
        if not known or time >= known[-1][0]:
            known.append((time, place))

    def root(self, frame: str) -> str:
        """The outermost frame that it lies in."""
        return self._outwards(frame)[-1]

    def find(self, frame: str, outer: str, time: float | None = None) -> Place | None:
        """The place of a frame in another, at about a time or as last known; None if nothing tells where it is."""
        there, here = self._outwards(frame), self._outwards(outer)
        common = next((name for name in there if name in here), None)
        if common is None:
            return None
        return between(self._in(outer, common, time), self._in(frame, common, time))

    def _outwards(self, frame: str) -> list[str]:
        found = [frame]
        while (parent := self._parents.get(found[-1])) is not None and parent not in found:
            found.append(parent)
        return found

    def _in(self, frame: str, outer: str, time: float | None) -> Place:
        place = HERE
        while frame != outer:
            place = after(self._at(frame, time), place)
            frame = self._parents[frame]
        return place

    def _at(self, frame: str, time: float | None) -> Place:
        known = self._places[frame]
        return known[-1][1] if time is None else min(reversed(known), key=lambda one: abs(one[0] - time))[1]
