"""BufferInterface of tf2_ros: what transforms objects of registered types, on top of what finds transforms."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from geometry_msgs.msg import TransformStamped
from rclpy.duration import Duration

from course_kit.robots.tf.registration import NotImplementedException, TransformRegistration, convert


class BufferInterface:
    """Subclasses have lookup_transform(), can_transform() and their relatives with `_full`."""

    def __init__(self) -> None:
        self.registration = TransformRegistration()

    def transform(
        self,
        object_stamped: Any,
        target_frame: str,
        timeout: Duration = Duration(),  # noqa: B008 - as tf2_ros has it
        new_type: type | None = None,
    ) -> Any:
        """An object in another frame, at the moment of its stamp.

        `import tf2_geometry_msgs` registers the types of geometry_msgs; TypeException for one that nobody has
        registered, TransformException if there is no transform within `timeout`.
        """
        return self._transformed(
            object_stamped,
            lambda header: self.lookup_transform(target_frame, header.frame_id, header.stamp, timeout),
            new_type,
        )

    def transform_full(
        self,
        object_stamped: Any,
        target_frame: str,
        target_time: Any,
        fixed_frame: str,
        timeout: Duration = Duration(),  # noqa: B008
        new_type: type | None = None,
    ) -> Any:
        """An object in another frame at another moment, while `fixed_frame` stands still."""
        return self._transformed(
            object_stamped,
            lambda header: self.lookup_transform_full(
                target_frame, target_time, header.frame_id, header.stamp, fixed_frame, timeout
            ),
            new_type,
        )

    def _transformed(
        self, object_stamped: Any, look_up: Callable[[Any], TransformStamped], new_type: type | None
    ) -> Any:
        do_transform = self.registration.get(type(object_stamped))  # refused before anything is waited for
        result = do_transform(object_stamped, look_up(object_stamped.header))
        return result if new_type is None else convert(result, new_type)

    def lookup_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: Any,
        timeout: Duration = Duration(),  # noqa: B008
    ) -> TransformStamped:
        """Where the source frame is in the target frame."""
        raise NotImplementedException

    def lookup_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Duration = Duration(),  # noqa: B008
    ) -> TransformStamped:
        """The same between two moments."""
        raise NotImplementedException

    def can_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: Any,
        timeout: Duration = Duration(),  # noqa: B008
    ) -> Any:
        """Return True if there is a transform."""
        raise NotImplementedException

    def can_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Duration = Duration(),  # noqa: B008
    ) -> Any:
        """The same between two moments."""
        raise NotImplementedException
