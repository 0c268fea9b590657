"""turtlesim as a process of its own: python -m course_kit.robots.turtlesim --ros-args -r __ns:=/robot1"""

from __future__ import annotations

from course_kit.robots.turtlesim.node import TurtleSim
from course_kit.ros.program import spin


def main(args: list[str] | None = None) -> None:
    """Run the simulator until Ctrl-C or SIGTERM; exit status 0."""
    spin("turtlesim", TurtleSim, args)


if __name__ == "__main__":
    main()
