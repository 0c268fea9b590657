"""Stands in for launch.logging."""

from course_kit.launching.output import get_logger
from course_kit.launching.uncovered import attributes_of

__all__ = ["get_logger"]
__getattr__ = attributes_of(__name__, __all__)
