"""A node of navigation as a process: python -m course_kit.robots.navigation mapper --ros-args -p resolution:=0.1"""

from __future__ import annotations

import importlib
import sys

from course_kit.ros.program import spin

NODES = {"mapper": "Mapper", "localizer": "Localizer", "planner": "Planner", "navigator": "Navigator"}


def main() -> None:
    """Run the node that the first argument names until Ctrl-C or SIGTERM; exit status 0."""
    name, *rest = sys.argv[1:] or [""]
    if name not in NODES:
        sys.exit(f"navigation cannot start: say which node, one of {', '.join(NODES)}, not {name!r}")
    module = importlib.import_module(f"course_kit.robots.navigation.{name}")
    spin(name, getattr(module, NODES[name]), rest)


if __name__ == "__main__":
    main()
