"""Stands in for the package `launch_ros` of ROS 2, for the part that a course needs."""

from course_kit.launching.uncovered import attributes_of

__getattr__ = attributes_of(__name__, ())
