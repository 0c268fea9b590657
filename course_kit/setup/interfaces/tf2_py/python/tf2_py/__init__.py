"""tf2 for Python: places of frames over time. The course's; course_kit.robots.tf does the work."""

from course_kit.robots.tf.core import BufferCore
from course_kit.robots.tf.errors import (
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TimeoutException,
    TransformException,
)

__all__ = [
    "BufferCore",
    "ConnectivityException",
    "ExtrapolationException",
    "InvalidArgumentException",
    "LookupException",
    "TimeoutException",
    "TransformException",
]
