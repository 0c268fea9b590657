"""Stands in for launch.launch_context."""

from course_kit.launching.context import LaunchContext
from course_kit.launching.uncovered import attributes_of

__all__ = ["LaunchContext"]
__getattr__ = attributes_of(__name__, __all__)
