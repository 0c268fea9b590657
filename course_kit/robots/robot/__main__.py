"""The robot as a process of its own: python -m course_kit.robots.robot --ros-args -p world:=maze -p seed:=3"""

from __future__ import annotations

import sys

from course_kit.robots.robot.node import Robot
from course_kit.ros.program import spin


def main(args: list[str] | None = None) -> None:
    """Run the robot until Ctrl-C or SIGTERM; exit status 0. Parameters that cannot be are one line, exit status 1."""
    try:
        spin("robot", Robot, args)
    except (TypeError, ValueError) as error:
        sys.exit(f"robot cannot start: {error}")


if __name__ == "__main__":
    main()
