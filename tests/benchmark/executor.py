"""The course's background executor against `rclpy.spin` in a plain script: latency, and how much it can take."""

from __future__ import annotations

import statistics
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from typing import Any

from tests.benchmark.ceiling import CEILING, KEPT, highest_rate
from tests.benchmark.child import Program
from tests.benchmark.table import Row, higher, lower
from tests.domains import reserve_domain

DEPTH = 100
NOTE = (
    "executor: a talker's timer publishes stamped messages, a listener's callback reads the stamp; µs from before "
    "publish() to the callback. plain: rclpy.spin in a script, both nodes in its one executor; course: run() for each. "
    f"Ceiling: {CEILING}; reliable, depth {DEPTH}, above 1 kHz in bursts at 500 Hz. Medians of repetitions in turn."
)
STYLES = ("plain", "course")


@dataclass
class Pair:
    """A talker and a listener in one process or in two."""

    talker: Program
    listener: Program

    def talk(self, rate: float, seconds: float) -> tuple[dict[str, Any], dict[str, Any]]:
        """Publish for a time; what the talker sent, what the listener heard."""
        self.talker.tell(f"talk {rate} {seconds}")
        sent = self.talker.report(seconds + 60)
        self.listener.tell("heard")
        return sent, self.listener.report()


def rows(quick: bool) -> Iterator[Row]:
    """All rows of this section."""
    for kind in ("String", "LaserScan"):
        for processes in (1, 2):
            with ExitStack() as stack:
                pairs = {style: _started(stack, style, kind, processes) for style in STYLES}
                name = f"{kind}, {'one process' if processes == 1 else 'two processes'}"
                for pair in pairs.values():
                    pair.talk(100, 0.5)  # the first messages meet cold caches and half-made connections
                for rate in (100, 1000):
                    yield from latency(name, pairs, rate, 1 if quick else 5, 1.0 if quick else 3.0)
                yield ceiling(name, pairs, 1 if quick else 3, 0.7 if quick else 1.0)


def _started(stack: ExitStack, style: str, kind: str, processes: int) -> Pair:
    domain = reserve_domain()
    roles = ["both"] if processes == 1 else ["talker", "listener"]
    programs = [stack.enter_context(Program("spin", style, role, kind, DEPTH, domain=domain)) for role in roles]
    for program in programs:
        program.report()
    return Pair(programs[0], programs[-1])


def latency(name: str, pairs: dict[str, Pair], rate: int, repetitions: int, seconds: float) -> Iterator[Row]:
    """Median and 99th percentile of the latency at a rate."""
    found: dict[str, list[dict[str, float]]] = {style: [] for style in STYLES}
    for repetition in range(repetitions):
        print(f"\rexecutor: {name}, {rate} Hz, {repetition + 1} of {repetitions} ", end="", file=sys.stderr)
        for style in STYLES if repetition % 2 else reversed(STYLES):
            found[style].append(pairs[style].talk(rate, seconds)[1])
    print(file=sys.stderr)
    for figure in ("median", "p99"):
        plain, course = (statistics.median(heard[figure] for heard in found[style]) for style in STYLES)
        yield lower(f"latency, {name}, {rate} Hz: {figure}", "µs", plain, course)


def ceiling(name: str, pairs: dict[str, Pair], repetitions: int, seconds: float) -> Row:
    """The highest rate without loss."""
    found: dict[str, list[float]] = {style: [] for style in STYLES}
    for repetition in range(repetitions):
        print(f"\rexecutor: {name}, ceiling, {repetition + 1} of {repetitions} ", end="", file=sys.stderr)
        for style in STYLES if repetition % 2 else reversed(STYLES):
            found[style].append(highest_rate(partial(_held, pairs[style], seconds)))
    print(file=sys.stderr)
    plain, course = (statistics.median(found[style]) for style in STYLES)
    return higher(f"ceiling, {name}", "messages/s", plain, course)


def _held(pair: Pair, seconds: float, rate: float) -> float | None:
    sent, heard = pair.talk(rate, seconds)
    return float(sent["rate"]) if heard["count"] == sent["sent"] and sent["rate"] >= KEPT * rate else None
