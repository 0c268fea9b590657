"""CPU and memory of the processes of nodes, live."""

from __future__ import annotations

from course_kit.base.arguments import SPAN, takes
from course_kit.lab.resources.resource_recording import PERIOD, record_resources
from course_kit.views.live.shown import Bundle
from course_kit.views.live.view import LONGEST, LiveView, as_tables


@takes(period=SPAN, seconds=SPAN)
def watch_resources(period: float = PERIOD, seconds: float = LONGEST) -> LiveView:
    """Show CPU and memory of all processes with ROS nodes, live: what htop shows, by node.

    It ends with .stop(), with the next run of its cell, or after `seconds`.
    """
    recording = record_resources(period=period)

    def draw() -> Bundle:
        return as_tables([recording.rows(), *recording.notes()], left=2)

    return LiveView("resources", draw, recording.stop, period, seconds)
