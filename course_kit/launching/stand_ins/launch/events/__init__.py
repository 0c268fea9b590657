"""Stands in for launch.events."""

from course_kit.launching.events import (
    ExecutionComplete,
    IncludeLaunchDescription,
    Shutdown,
    TimerEvent,
    matches_action,
)
from course_kit.launching.uncovered import attributes_of

__all__ = ["ExecutionComplete", "IncludeLaunchDescription", "Shutdown", "TimerEvent", "matches_action"]
__getattr__ = attributes_of(__name__, __all__)
