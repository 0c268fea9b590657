"""How steady turtlesim ticks: in a notebook's process and in its own, at rest and beside something busy."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack

import numpy as np

from course_kit.robots.turtlesim.turtle import TICK
from tests.benchmark.child import Program
from tests.benchmark.table import Row
from tests.domains import reserve_domain

NOTE = (
    "turtle: the times at which turtle1's poses were published, by the middleware's stamps. Late: the 99th percentile "
    "of a period's difference from 16 ms. Drift: how far the last second's ticks are off the first second's beat."
)
PERIOD = TICK * 1000  # ms


def rows(quick: bool) -> Iterator[Row]:
    """All rows of this section."""
    seconds = 2.0 if quick else 10.0
    for where in ("in the notebook's process", "as a process of its own"):
        for busy in (False, True):
            with ExitStack() as stack:
                domain = reserve_domain()
                own = where.startswith("as")
                turtle = stack.enter_context(
                    Program("course_kit.robots.turtlesim" if own else "turtle_host", domain=domain)
                )
                if own and busy:
                    stack.enter_context(Program("busy", domain=domain)).report()
                if not own:
                    turtle.report()
                watcher = stack.enter_context(Program("pose_stamps", domain=domain))
                watcher.report()
                if not own:
                    turtle.tell(f"{'work' if busy else 'rest'} {seconds + 1}")
                watcher.tell(f"watch {seconds}")
                found = np.array(watcher.report(seconds + 30)["stamps"])
            what = f"turtle {where}, {'beside a busy ' + ('process' if own else 'cell') if busy else 'at rest'}"
            yield from _figures(what, (found - found[0]) * 1e-6, seconds)


def _figures(what: str, stamps: np.ndarray, seconds: float) -> Iterator[Row]:
    periods = np.diff(stamps)
    median = float(np.median(periods))
    yield Row(f"{what}: period", "ms", None, median, f"{PERIOD:g} ± 1 %", abs(median / PERIOD - 1) <= 0.01)
    yield Row(f"{what}: late", "ms", None, float(np.percentile(np.abs(periods - PERIOD), 99)))
    drift = _drift(stamps)
    yield Row(f"{what}: drift in {seconds:g} s", "ms", None, drift, "within a tick", abs(drift) <= PERIOD)
    missing = round((stamps[-1] - stamps[0]) / PERIOD) - len(periods)
    yield Row(f"{what}: ticks missing in {seconds:g} s", f"of {seconds / TICK:.0f}", None, missing)


def _drift(stamps: np.ndarray) -> float:
    """How far the ticks of the last second are off the beat of the first second's, in ms."""
    seconds = np.array_split(stamps, max(2, round((stamps[-1] - stamps[0]) / 1000)))
    beats = [np.angle(np.exp(2j * np.pi * one / PERIOD).mean()) for one in seconds]
    return float(np.ptp(np.unwrap(beats)[[0, -1]]) * PERIOD / (2 * np.pi))
