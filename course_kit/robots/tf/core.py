"""BufferCore of tf2_py: transforms go in and come out as messages."""

from __future__ import annotations

from typing import Any

from geometry_msgs.msg import TransformStamped
from rclpy.duration import Duration
from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.logging import get_logger
from rclpy.time import Time

from course_kit.robots.tf import refusals
from course_kit.robots.tf.conversions import nanoseconds, sample, time_of, transform_stamped
from course_kit.robots.tf.errors import TransformException
from course_kit.robots.tf.link_history import Link, seconds
from course_kit.robots.tf.tree import CACHE_TIME, Tree

SHORTEST = 100_000  # ns; the rate of a link is never told over less


class BufferCore:
    """Frames, and where they have been in each other for the last `cache_time`, a Duration; 10 s unless given.

    Times are rclpy's or messages; one of zero means the latest moment for which a transform is known.
    """

    def __init__(self, cache_time: Duration | None = None) -> None:
        # A listener has its node say it in place of this one, which no node knows and so no /rosout has.
        self.logger: RcutilsLogger = get_logger("tf2_buffer")
        self.tree = Tree(CACHE_TIME if cache_time is None else nanoseconds(cache_time, "cache_time"))

    def set_transform(self, transform: TransformStamped, authority: str) -> None:
        """Take in where a frame is in its parent at a moment, as `authority` says. What makes no sense is logged."""
        self._add(transform, authority, is_static=False)

    def set_transform_static(self, transform: TransformStamped, authority: str) -> None:
        """Take in where a frame is in its parent at all times."""
        self._add(transform, authority, is_static=True)

    def _add(self, transform: TransformStamped, authority: str, is_static: bool) -> None:
        child, one = sample(transform)
        refused = refusals.refusals(child, one, authority)
        for line in refused:
            self.logger.error(line)
        if not refused and not self.tree.add(child, one, authority, is_static):
            self.logger.warning(refusals.too_old(child, one.stamp, authority))

    def lookup_transform_core(self, target_frame: str, source_frame: str, time: Any) -> TransformStamped:
        """The transform that is known now. TransformException if there is none."""
        where, stamp = self.tree.lookup(target_frame, source_frame, nanoseconds(time))
        return transform_stamped(target_frame, source_frame, stamp, where)

    def lookup_transform_full_core(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> TransformStamped:
        """The same between two moments, while `fixed_frame` stands still."""
        where, stamp = self.tree.lookup_full(
            target_frame, nanoseconds(target_time), source_frame, nanoseconds(source_time), fixed_frame
        )
        return transform_stamped(target_frame, source_frame, stamp, where)

    def can_transform_core(self, target_frame: str, source_frame: str, time: Any) -> tuple[bool, str]:
        """Return True if there is a transform now, and if not, why."""
        problem = self.tree.problem(target_frame, source_frame, nanoseconds(time))
        return not problem, problem

    def can_transform_full_core(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> tuple[bool, str]:
        """The same between two moments, while `fixed_frame` stands still."""
        problem = self.tree.problem_full(
            target_frame, nanoseconds(target_time), source_frame, nanoseconds(source_time), fixed_frame
        )
        return not problem, problem

    def get_latest_common_time(self, target_frame: str, source_frame: str) -> Time:
        """The latest moment for which there is a transform. TransformException if there is none."""
        for name in (target_frame, source_frame):
            self.tree.check_name("get_latest_common_time", name)
        try:
            return time_of(self.tree.latest_common_time(target_frame, source_frame))
        except TransformException as error:
            raise TransformException(str(error)) from None  # as tf2_py, which does not tell the kinds apart here

    def clear(self) -> None:
        """Forget where frames have been. They stay known, and static ones stay where they are."""
        self.tree.clear()

    def all_frames_as_string(self) -> str:
        """A line for each frame that has a parent."""
        return self.tree.as_text()

    def all_frames_as_yaml(self) -> str:
        """For each frame its parent, who sends it, how often, and from when to when it is known; times in s."""
        return "".join(self.tree.each_link(_as_yaml)) if self.tree.names() else "[]"

    def _frameExists(self, frame_id: str) -> bool:  # noqa: N802 - as tf2_py spells it
        return frame_id in self.tree.names()

    def _getFrameStrings(self) -> list[str]:  # noqa: N802
        return self.tree.names()


def _as_yaml(child: str, link: Link, authority: str) -> str:
    span = link.latest - link.oldest
    return (
        f"{child}: \n"
        f"  parent: '{link.parent}'\n"
        f"  broadcaster: '{authority}'\n"
        f"  rate: {len(link) * 1e9 / max(span, SHORTEST):.3f}\n"
        f"  most_recent_transform: {seconds(link.latest)}\n"
        f"  oldest_transform: {seconds(link.oldest)}\n"
        f"  buffer_length: {span * 1e-9:.3f}\n"
    )
