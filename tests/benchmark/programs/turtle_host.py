"""A turtlesim in a notebook's manner, run(TurtleSim): the commands `rest SECONDS` and `work SECONDS` are its cells."""

from __future__ import annotations

import sys
import time

from course_kit import run
from course_kit.robots.turtlesim.node import TurtleSim
from tests.benchmark.programs.reporting import report


def work(seconds: float) -> None:
    """A cell of pure Python that keeps the interpreter busy."""
    end = time.monotonic() + seconds
    count = 0
    while time.monotonic() < end:
        for number in range(1000):
            count += number * number


def main() -> None:
    run(TurtleSim)
    report(ready=True)
    for line in sys.stdin:
        command, seconds = line.split()
        (work if command == "work" else time.sleep)(float(seconds))
        report(done=command)


if __name__ == "__main__":
    main()
