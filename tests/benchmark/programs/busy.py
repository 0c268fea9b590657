"""A process that keeps one core busy with Python until its input ends."""

from __future__ import annotations

import threading

from tests.benchmark.programs.reporting import at_end_of_input, report


def main() -> None:
    ended = threading.Event()
    at_end_of_input(ended.set)
    report(ready=True)
    count = 0
    while not ended.is_set():
        for number in range(1000):
            count += number * number


if __name__ == "__main__":
    main()
