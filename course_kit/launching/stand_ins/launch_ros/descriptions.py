"""Stands in for launch_ros.descriptions."""

from course_kit.launching.parameters import ParameterFile, ParameterValue
from course_kit.launching.uncovered import attributes_of

__all__ = ["ParameterFile", "ParameterValue"]
__getattr__ = attributes_of(__name__, __all__)
