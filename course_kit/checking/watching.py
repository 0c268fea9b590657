"""What the checker listens to in the student's domain over a whole session, because an exercise asks what happened."""

from __future__ import annotations

import importlib
from typing import Any

from course_kit.checking.station import Heard, Station

# A topic that nobody may publish yet has no type to look up.
TYPES = {
    "/rosout": ("rcl_interfaces.msg", "Log"),
    "/turtle1/pose": ("turtlesim.msg", "Pose"),
    "/robot2/turtle1/pose": ("turtlesim.msg", "Pose"),
}
KEPT_FOR_NEWCOMERS = frozenset({"/rosout"})


def open_watch(station: Station, topic: str) -> Heard:
    """Listen to a topic from now on, until the checker ends; of the last 20,000 messages."""
    module, name = TYPES[topic]
    message_type: Any = getattr(importlib.import_module(module), name)
    listen = station.listen_late if topic in KEPT_FOR_NEWCOMERS else station.listen
    heard = listen(topic, message_type)
    station.keep(heard)
    if topic in KEPT_FOR_NEWCOMERS:
        station.look_at_publishers(heard, topic)
    return heard
