"""The highest rate that record() holds without loss, beside a plain rclpy script that keeps messages in a list."""

from __future__ import annotations

import statistics
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from functools import partial

from tests.benchmark.ceiling import CEILING, KEPT, highest_rate
from tests.benchmark.child import Program
from tests.benchmark.table import Row, higher
from tests.domains import reserve_domain

DEPTH = 5000
NOTE = (
    f"recorder: {CEILING}. The sender is another process and publishes serialised messages (reliable, depth {DEPTH}); "
    "plain: rclpy.spin and a callback that appends to a list, also with this depth."
)
STYLES = ("plain", "course")
KINDS = {"String": "string", "LaserScan(360)": "scan"}


def rows(quick: bool) -> Iterator[Row]:
    """All rows of this section."""
    for name, kind in KINDS.items():
        found: dict[str, list[float]] = {style: [] for style in STYLES}
        with ExitStack() as stack:
            programs = {
                style: stack.enter_context(Program("recorder", style, kind, DEPTH, domain=reserve_domain()))
                for style in STYLES
            }
            for program in programs.values():
                program.report()
            for repetition in range(1 if quick else 2):
                print(f"\rrecorder: {name}, {repetition + 1} ", end="", file=sys.stderr)
                for style in STYLES if repetition % 2 else reversed(STYLES):
                    program = programs[style]
                    seconds = 1.0 if quick else 1.5
                    found[style].append(highest_rate(partial(_held, program, seconds)))
        print(file=sys.stderr)
        plain, course = (statistics.median(found[style]) for style in STYLES)
        yield higher(f"recorded without loss, {name}", "messages/s", plain, course)


def _held(program: Program, seconds: float, rate: float) -> float | None:
    program.tell(f"record {rate} {seconds}")
    result = program.report(seconds + 90)
    return float(result["rate"]) if result["received"] == result["sent"] and result["rate"] >= KEPT * rate else None
