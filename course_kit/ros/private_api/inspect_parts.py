"""Files and modules as Python's inspect knows them. rclpy looks its caller up there at each logged line."""

from __future__ import annotations

import inspect
from typing import Any

from course_kit.ros.private_api import expect, going_on_without


def know_cell(path: str) -> None:
    """Have inspect know that the code of this file is the notebook's; else it looks through all modules each time."""
    with going_on_without("each line that a node logs takes 5 ms more"):
        expect("Python", inspect, "modulesbyfile")
        known: Any = inspect
        known.modulesbyfile[path] = "__main__"
