"""Stands in for launch.launch_description."""

from course_kit.ros2.launching.entities import LaunchDescription
from course_kit.ros2.launching.uncovered import attributes_of

__all__ = ["LaunchDescription"]
__getattr__ = attributes_of(__name__, __all__)
