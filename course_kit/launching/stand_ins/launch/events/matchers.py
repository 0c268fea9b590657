"""Stands in for launch.events.matchers."""

from course_kit.launching.events import matches_action
from course_kit.launching.uncovered import attributes_of

__all__ = ["matches_action"]
__getattr__ = attributes_of(__name__, __all__)
