"""What the checker listens to in the student's domain over a whole session, because an exercise asks what happened."""

from __future__ import annotations

import importlib
from typing import Any

from course_kit.examining.station import Heard, Station

# A topic that nobody may publish yet has no type to look up.
TYPES = {
    "/turtle1/pose": ("turtlesim.msg", "Pose"),
    "/robot2/turtle1/pose": ("turtlesim.msg", "Pose"),
}


def open_watch(station: Station, topic: str) -> Heard:
    """Listen to a topic from now on, until the checker ends; of the last 20,000 messages."""
    module, name = TYPES[topic]
    message_type: Any = getattr(importlib.import_module(module), name)
    heard = station.listen(topic, message_type)
    station.keep(heard)
    return heard
