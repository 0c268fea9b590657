"""Stands in for launch.launch_description."""

from course_kit.launching.entities import LaunchDescription
from course_kit.launching.uncovered import attributes_of

__all__ = ["LaunchDescription"]
__getattr__ = attributes_of(__name__, __all__)
