"""A robot with physics: two wheels, a laser, walls; on the names and types of a TurtleBot on ROS 2 Jazzy."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from course_kit.robot.node import Robot as Robot


def __getattr__(name: str) -> Any:
    # Lazily, because the pure parts are used where no ROS is, and nothing loads MuJoCo before a robot is there.
    if name != "Robot":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return importlib.import_module(f"{__name__}.node").Robot
