"""The history of one frame in its parent: samples over time, and the place between two of them. No ROS."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from typing import NamedTuple

from course_kit.robots.tf.rigid_transforms import RigidTransform

NEVER = 0  # ns; as a moment that is asked for it means the latest, and a static link has no other


class Sample(NamedTuple):
    """Where a frame was at a moment, in which parent."""

    stamp: int  # ns
    parent: str
    placement: RigidTransform

    def same(self, other: Sample) -> bool:
        """Return True if it says the same."""
        equal = (self.placement.translation == other.placement.translation).all()
        return self.parent == other.parent and equal and (self.placement.rotation == other.placement.rotation).all()


class Found(NamedTuple):
    """What a link knows of a moment: one sample, or two between which the moment is."""

    older: Sample
    newer: Sample
    ratio: float

    def placement(self) -> RigidTransform:
        """Where the frame was."""
        if self.older is self.newer or self.older.parent != self.newer.parent:
            return self.older.placement
        return self.older.placement.towards(self.newer.placement, self.ratio)


class NotFound(NamedTuple):
    """Why a link knows nothing of a moment."""

    reason: str


def seconds(stamp: int) -> str:
    """A moment in ns as tf2 writes it."""
    return f"{stamp * 1e-9:.6f}"


class Link:
    """The samples of a frame, by their stamps. Not safe between threads."""

    def __init__(self, cache_time: int, is_static: bool) -> None:
        self.cache_time = cache_time  # ns that samples are kept behind the latest one
        self.is_static = is_static
        self._stamps: list[int] = []
        self._samples: list[Sample] = []

    def __len__(self) -> int:
        return len(self._samples)

    def add(self, sample: Sample) -> bool:
        """Drop samples that are too old, and take one in; False for one that is too old itself.

        As in tf2, the latest sample but one decides what is too old: between two that are far apart it can be
        interpolated, until a third comes.
        """
        if self.is_static:
            self._stamps, self._samples = [NEVER], [sample]
            return True
        oldest = self.latest - self.cache_time
        old = bisect_left(self._stamps, oldest)
        del self._stamps[:old], self._samples[:old]
        if self._stamps and sample.stamp < oldest:
            return False
        at = bisect_right(self._stamps, sample.stamp)
        equal = self._samples[bisect_left(self._stamps, sample.stamp) : at]
        if not any(sample.same(other) for other in equal):
            self._stamps.insert(at, sample.stamp)
            self._samples.insert(at, sample)
        return True

    def clear(self) -> None:
        """Forget the samples of a link that moves."""
        if not self.is_static:
            self._stamps, self._samples = [], []

    @property
    def latest(self) -> int:
        """The newest stamp in ns; NEVER if there is none."""
        return self._stamps[-1] if self._stamps else NEVER

    @property
    def oldest(self) -> int:
        """The oldest stamp in ns; NEVER if there is none."""
        return self._stamps[0] if self._stamps else NEVER

    @property
    def parent(self) -> str:
        """The parent of the newest sample; '' if there is none."""
        return self._samples[-1].parent if self._samples else ""

    def at(self, moment: int) -> Found | NotFound:
        """What is known of a moment in ns. Nothing is said of moments before the oldest and after the newest sample."""
        if not self._samples:
            return NotFound("")
        if self.is_static or moment == NEVER:
            return Found(self._samples[-1], self._samples[-1], 0.0)
        if len(self._samples) == 1 and moment != self.latest:
            return NotFound(
                f"Lookup would require extrapolation at time {seconds(moment)}, "
                f"but only time {seconds(self.latest)} is in the buffer"
            )
        if moment > self.latest:
            return NotFound(
                f"Lookup would require extrapolation into the future.  Requested time {seconds(moment)} "
                f"but the latest data is at time {seconds(self.latest)}"
            )
        if moment < self.oldest:
            return NotFound(
                f"Lookup would require extrapolation into the past.  Requested time {seconds(moment)} "
                f"but the earliest data is at time {seconds(self.oldest)}"
            )
        after = bisect_right(self._stamps, moment)
        older = self._samples[after - 1]
        if older.stamp == moment:
            return Found(older, older, 0.0)
        newer = self._samples[after]
        return Found(older, newer, (moment - older.stamp) / (newer.stamp - older.stamp))
