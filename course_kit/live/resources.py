"""CPU and memory of the processes of nodes, live."""

from __future__ import annotations

from course_kit.live.view import LONGEST, LiveView, as_text
from course_kit.resources.resource_recording import PERIOD, record_resources


def watch_resources(period: float = PERIOD, seconds: float = LONGEST) -> LiveView:
    """Show CPU and memory of all processes with ROS nodes, live: what htop shows, by node.

    It ends with .stop(), with the next run of its cell, or after `seconds`.
    """
    recording = record_resources(period=period)
    return LiveView("resources", lambda: as_text(repr(recording)), recording.stop, period, seconds)
