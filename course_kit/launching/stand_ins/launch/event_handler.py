"""Stands in for launch.event_handler."""

from course_kit.launching.handlers import EventHandler
from course_kit.launching.uncovered import attributes_of

__all__ = ["EventHandler"]
__getattr__ = attributes_of(__name__, __all__)
