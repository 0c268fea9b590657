"""A robot in a notebook's manner, run(Robot, factor=…): `time` reports its simulated time."""

from __future__ import annotations

import sys

from course_kit import run
from course_kit.robots.robot.node import Robot
from tests.benchmark.programs.reporting import report


def main() -> None:
    robot = run(Robot, factor=float(sys.argv[1]))
    report(ready=True)
    for _ in sys.stdin:
        report(time=robot.simulation.time)


if __name__ == "__main__":
    main()
