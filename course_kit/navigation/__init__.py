"""A robot finds its way: a map from scans, where it is on one, a path, and how to follow it. Examples to read.

Of each step there is a pure part in numpy and a small node: grid and scan_matching (Mapper), localization (Localizer),
planning (Planner), pursuit and journey (Navigator).
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from course_kit.navigation.localizer import Localizer as Localizer
    from course_kit.navigation.mapper import Mapper as Mapper
    from course_kit.navigation.navigator import Navigator as Navigator
    from course_kit.navigation.planner import Planner as Planner

NODES = {"mapper": "Mapper", "localizer": "Localizer", "planner": "Planner", "navigator": "Navigator"}


def __getattr__(name: str) -> Any:
    # Lazily, because the pure parts are used where no ROS is.
    module = next((module for module, node in NODES.items() if node == name), None)
    if module is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"{__name__}.{module}"), name)
