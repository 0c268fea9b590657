"""Stands in for launch.event_handlers."""

from course_kit.launching.handlers import OnExecutionComplete, OnProcessExit, OnProcessIO, OnProcessStart, OnShutdown
from course_kit.launching.uncovered import attributes_of

__all__ = ["OnExecutionComplete", "OnProcessExit", "OnProcessIO", "OnProcessStart", "OnShutdown"]
__getattr__ = attributes_of(__name__, __all__)
