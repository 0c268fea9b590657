"""Stands in for launch.action."""

from course_kit.launching.entities import Action
from course_kit.launching.uncovered import attributes_of

__all__ = ["Action"]
__getattr__ = attributes_of(__name__, __all__)
