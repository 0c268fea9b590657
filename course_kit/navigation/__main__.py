"""A node of navigation as a process of its own: python -m course_kit.navigation mapper --ros-args -p resolution:=0.1"""

from __future__ import annotations

import sys

from course_kit import navigation
from course_kit.navigation import NODES
from course_kit.turtlesim.program import spin


def main() -> None:
    """Run the node that the first argument names until Ctrl-C or SIGTERM; exit status 0."""
    name, *rest = sys.argv[1:] or [""]
    if name not in NODES:
        sys.exit(f"navigation cannot start: say which node, one of {', '.join(NODES)}, not {name!r}")
    spin(name, getattr(navigation, NODES[name]), rest)


if __name__ == "__main__":
    main()
