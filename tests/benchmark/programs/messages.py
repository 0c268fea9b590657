"""The messages that are measured: String, LaserScan with 360 ranges, Image of 640 x 480, each with number and time."""

from __future__ import annotations

import time
from typing import Any

from sensor_msgs.msg import Image, LaserScan
from std_msgs.msg import String

TYPES: dict[str, Any] = {"String": String, "LaserScan": LaserScan, "Image": Image}


def template(kind: str) -> Any:
    """A full message of a kind, to be stamped again and again."""
    if kind == "String":
        return String()
    if kind == "LaserScan":
        return LaserScan(ranges=[1.0 + i / 360 for i in range(360)], range_max=10.0)
    return Image(height=480, width=640, encoding="rgb8", step=3 * 640, data=bytes(3 * 640 * 480))


def stamp(message: Any, sequence: int) -> None:
    """Write a sequence number and the present time into a message."""
    text = f"{sequence} {time.monotonic_ns()}"
    if isinstance(message, String):
        message.data = text
    else:
        message.header.frame_id = text


def read(message: Any) -> tuple[int, int]:
    """The sequence number of a message and the nanoseconds since it was stamped, in whichever process that was."""
    now = time.monotonic_ns()
    text = message.data if isinstance(message, String) else message.header.frame_id
    sequence, _, sent = text.partition(" ")
    return int(sequence), now - int(sent)
