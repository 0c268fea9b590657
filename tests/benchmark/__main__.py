"""Measures the course against plain rclpy and prints one table: `python -m tests.benchmark [section ...] [--quick]`."""

from __future__ import annotations

import argparse
import importlib
import os
import platform
import sys
import time

from tests.benchmark.table import Row, formatted

SECTIONS = (
    "discovery",
    "executor",
    "recorder",
    "rates",
    "turtle",
    "robot",
    "physics",
    "panel",
    "ros2",
    "verbs",
    "bags",
    "setup",
    "students",
    "users",
    "leftovers",
    "dead_segments",
    "notebooks",
)


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.benchmark", description=__doc__)
    parser.add_argument("section", nargs="*", help=f"{', '.join(SECTIONS)}; all of them without one")
    parser.add_argument("--quick", action="store_true", help="fewer and shorter runs: a look, not a measurement")
    arguments = parser.parse_args()
    unknown = [name for name in arguments.section if name not in SECTIONS]
    if unknown:
        parser.error(f"no section {unknown[0]}; there are {', '.join(SECTIONS)}")
    table: list[Row] = []
    notes = []
    for name in arguments.section or SECTIONS:
        section = importlib.import_module(f"tests.benchmark.{name}")
        began = time.monotonic()
        for row in section.rows(arguments.quick):
            table.append(row)
            print(" | ".join(row.cells()), file=sys.stderr)
        print(f"{name}: {time.monotonic() - began:.0f} s, load {os.getloadavg()[0]:.2f}", file=sys.stderr)
        notes.append(section.NOTE)
    print(f"{os.cpu_count()} cores, Python {platform.python_version()}{', quick' if arguments.quick else ''}\n")
    print(formatted(table), *notes, sep="\n\n")
    return 0 if all(row.met is not False for row in table) else 1


if __name__ == "__main__":
    sys.exit(main())
