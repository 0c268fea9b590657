"""All frames and their links: which transforms there are, and what they are. No ROS; safe between threads."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import NamedTuple

from course_kit.robots.tf.errors import (
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TransformException,
)
from course_kit.robots.tf.link_history import NEVER, Found, Link, NotFound, Sample
from course_kit.robots.tf.rigid_transforms import IDENTITY, RigidTransform

CACHE_TIME = 10 * 10**9  # ns
DEEPEST = 1000  # links; a longer way is a loop


class Way(NamedTuple):
    """What leads from one frame to another at a moment: links up to a frame that both have above them, from each."""

    source: list[Found]
    target: list[Found]
    moment: int  # ns


class Tree:
    """Frames by their names, each with the link to its parent. Moments are whole numbers of ns; 0 means the latest.

    What cannot be had is raised as in tf2, in tf2's words.
    """

    def __init__(self, cache_time: int = CACHE_TIME) -> None:
        self.cache_time = cache_time  # ns
        self._lock = threading.RLock()
        self._links: dict[str, Link | None] = {}  # in the order in which they became known; roots have none
        self._authorities: dict[str, str] = {}

    # What is known

    def add(self, child: str, sample: Sample, authority: str, is_static: bool) -> bool:
        """Take in where a frame is in its parent; False if that is older than what is kept."""
        with self._lock:
            link = self._links.get(child)
            if link is None or link.is_static is not is_static:
                link = Link(self.cache_time, is_static)
                self._links[child] = link
            self._links.setdefault(sample.parent, None)
            if not link.add(sample):
                return False
            self._authorities[child] = authority
            return True

    def clear(self) -> None:
        """Forget where frames have been; they stay known, and static ones stay where they are."""
        with self._lock:
            for link in self._links.values():
                if link is not None:
                    link.clear()

    def names(self) -> list[str]:
        """The frames in the order in which they became known."""
        with self._lock:
            return list(self._links)

    def parent(self, name: str, moment: int = NEVER) -> str:
        """The frame above one at a moment; '' if that is not known."""
        with self._lock:
            link = self._links.get(name)
            found = link.at(moment) if link is not None else None
            return found.older.parent if isinstance(found, Found) else ""

    def as_text(self) -> str:
        """A line for each frame with a parent."""
        with self._lock:
            return "".join(
                f"Frame {name} exists with parent {link.parent or 'NO_PARENT'}.\n"
                for name, link in self._links.items()
                if link is not None
            )

    def each_link(self, describe: Callable[[str, Link, str], str]) -> list[str]:
        """describe(child, link, authority) of each link that has samples."""
        with self._lock:
            known = [(name, link) for name, link in self._links.items() if link is not None and len(link)]
            return [describe(name, link, self._authorities.get(name, "no recorded authority")) for name, link in known]

    # What follows from it

    def lookup(self, target: str, source: str, moment: int) -> tuple[RigidTransform, int]:
        """Where the source frame is in the target frame, and the moment for which that is true."""
        with self._lock:
            if target == source:
                link = self._links.get(target)
                return IDENTITY, link.latest if link is not None and moment == NEVER else moment
            self.check_name("lookupTransform argument target_frame", target)
            self.check_name("lookupTransform argument source_frame", source)
            way = self._way(target, source, moment)
        return _chained(way.target).inverse() @ _chained(way.source), way.moment

    def lookup_full(
        self, target: str, target_moment: int, source: str, source_moment: int, fixed: str
    ) -> tuple[RigidTransform, int]:
        """Where the source frame was at one moment in the target frame of another, while `fixed` stood still."""
        with self._lock:
            for role, name in (("target", target), ("source", source), ("fixed", fixed)):
                self.check_name(f"lookupTransform argument {role}_frame", name)
            before, _ = self.lookup(fixed, source, source_moment)
            after, moment = self.lookup(target, fixed, target_moment)
        return after @ before, moment

    def problem(self, target: str, source: str, moment: int) -> str:
        """Why there is no such transform; '' if there is one."""
        with self._lock:
            if target == source:
                return ""
            named = [("target", target), ("source", source)]
            return self._misnamed(named) or self._no_way(target, source, moment)

    def problem_full(self, target: str, target_moment: int, source: str, source_moment: int, fixed: str) -> str:
        """The same of lookup_full()."""
        with self._lock:
            return (
                self._misnamed([("target", target), ("source", source), ("fixed", fixed)])
                or self._no_way(target, fixed, target_moment)
                or self._no_way(fixed, source, source_moment)
            )

    def latest_common_time(self, target: str, source: str) -> int:
        """The latest moment in ns for which all links between two frames are known; 0 if all are static."""
        with self._lock:
            if target == source:
                link = self._links.get(target)
                return link.latest if link is not None else NEVER
            up_from_source = self._newest_way_up(source, target)
            if up_from_source and up_from_source[-1].parent == target:
                return _earliest(up_from_source)
            up_from_target = self._newest_way_up(target, source)
            if up_from_target and up_from_target[-1].parent == source:
                return _earliest(up_from_target)
            parents = [link.parent for link in up_from_source]
            for count, link in enumerate(up_from_target, 1):
                if link.parent in parents:
                    return _earliest(up_from_target[:count] + up_from_source[: parents.index(link.parent) + 1])
            raise ConnectivityException(_unconnected(target, source))

    def check_name(self, what: str, name: str) -> None:
        """Raise what tf2 raises for a name that is none, or that of no frame."""
        problem = _not_a_name(name)
        if problem:
            raise InvalidArgumentException(f'Invalid argument "{name}" passed to {what} - {problem}')
        with self._lock:
            if name not in self._links:
                raise LookupException(f'"{name}" passed to {what} does not exist. ')

    def _misnamed(self, named: list[tuple[str, str]]) -> str:
        for role, name in named:
            problem = _not_a_name(name) or ("" if name in self._links else "frame does not exist")
            if problem:
                return f'Invalid frame ID "{name}" passed to canTransform argument {role}_frame - {problem}'
        return ""

    def _no_way(self, target: str, source: str, moment: int) -> str:
        try:
            if target != source:
                self._way(target, source, moment)
        except TransformException as error:
            return str(error)
        return ""

    def _way(self, target: str, source: str, moment: int) -> Way:
        if moment == NEVER:
            moment = self.latest_common_time(target, source)
        up, top, missing = self._climb(source, (target,), moment)
        if top == target:
            return Way([found for _, found in up], [], moment)
        down, end, missing_below = self._climb(target, (top, source), moment)
        if end == source:
            return Way([], [found for _, found in down], moment)
        missing = missing_below or (missing if end != top else None)
        if missing:
            where = f"when looking up transform from frame [{source}] to frame [{target}]"
            raise ExtrapolationException(f"{missing.reason}, {where}")
        if end != top:
            raise ConnectivityException(_unconnected(target, source))
        while up and down and up[-1][0] == down[-1][0]:  # above the lowest frame that is above both
            del up[-1], down[-1]
        return Way([found for _, found in up], [found for _, found in down], moment)

    def _climb(
        self, name: str, ends: tuple[str, ...], moment: int
    ) -> tuple[list[tuple[str, Found]], str, NotFound | None]:
        """The links from a frame up to one of `ends`, or as far as they are known; where that is, why no further."""
        steps: list[tuple[str, Found]] = []
        while name not in ends and (link := self._links.get(name)) is not None:
            found = link.at(moment)
            if isinstance(found, NotFound):
                return steps, name, found
            steps.append((name, found))
            name = found.older.parent
            self._check_depth(len(steps))
        return steps, name, None

    def _newest_way_up(self, name: str, end: str) -> list[Link]:
        way: list[Link] = []
        while (link := self._links.get(name)) is not None and link.parent:
            way.append(link)
            name = link.parent
            if name == end:
                break
            self._check_depth(len(way))
        return way

    def _check_depth(self, depth: int) -> None:
        if depth > DEEPEST:
            raise LookupException(f"The tf tree is invalid because it contains a loop.\n{self.as_text()}\n")


def _not_a_name(name: str) -> str:
    if not isinstance(name, str):
        raise TypeError(f"a frame is named by a text, not by {name!r}")
    if not name:
        return "in tf2 frame_ids cannot be empty"
    return "in tf2 frame_ids cannot start with a '/'" if name.startswith("/") else ""


def _unconnected(target: str, source: str) -> str:
    return (
        f"Could not find a connection between '{target}' and '{source}' because they are not part of the same tree."
        "Tf has two or more unconnected trees."
    )


def _earliest(links: list[Link]) -> int:
    return min((link.latest for link in links if link.latest != NEVER), default=NEVER)


def _chained(way: list[Found]) -> RigidTransform:
    """Where the lowest frame of a way up is in the highest."""
    placement = IDENTITY
    for found in way:
        placement = found.placement() @ placement
    return placement
