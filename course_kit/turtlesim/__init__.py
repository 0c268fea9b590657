"""A turtlesim without a window: the simulator and its keyboard, on the names and types of the original; a laser."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from course_kit.turtlesim.laser import Laser as Laser
    from course_kit.turtlesim.node import TurtleSim as TurtleSim
    from course_kit.turtlesim.teleop import Teleop as Teleop


def __getattr__(name: str) -> Any:
    # Lazily, because the pure parts (world, field, picture) are used where no ROS is.
    module = {"TurtleSim": "node", "Teleop": "teleop", "Laser": "laser"}.get(name)
    if module is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"{__name__}.{module}"), name)
