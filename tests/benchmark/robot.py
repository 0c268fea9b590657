"""The robot with physics as a process of its own, heard by another one: what it takes of a core, how it hurries."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

import psutil  # type: ignore[import-untyped]

from tests.benchmark.child import Program
from tests.benchmark.table import Row, at_least, at_most
from tests.domains import reserve_domain

NOTE = (
    "robot: run(Robot) in a process that does nothing else, in the world rooms; another one hears all its topics and "
    "drives it in a circle. Of a core: what the robot's process takes. Hurried: at factor 0. "
    "Memory: of the robot's process, after its first five simulated minutes, hurried, and how much more an hour later."
)
SETTLING = 2.0  # s after the first message
GROWTH = 2.0  # MB in an hour
WARM = 300.0  # simulated s until which memory may grow: buffers, and what the robot remembers of its way


def rows(quick: bool) -> Iterator[Row]:
    """All rows of this section."""
    seconds = 2.0 if quick else 10.0
    for factor, what in ((1, "at real time"), (5, "at factor 5"), (0, "hurried")):
        with heard(factor) as robot:
            process = psutil.Process(robot.pid)
            before, began, simulated = _work(process), time.monotonic(), simulated_time(robot)
            time.sleep(seconds)
            passed = simulated_time(robot) - simulated
            took = time.monotonic() - began
            share = 100 * (_work(process) - before) / took
        if factor == 1:
            yield at_most(f"robot {what}", "% of a core", share, 25)
        else:
            yield Row(f"robot {what}", "% of a core", None, share)
        if factor == 0:
            yield at_least(f"robot {what}", "x real time", passed / took, 20)
        else:
            yield Row(f"robot {what}", "x real time", None, passed / took)
    yield from an_hour(120.0 if quick else 3600.0)


def an_hour(length: float) -> Iterator[Row]:
    """What so many simulated seconds cost in memory."""
    with heard(0) as robot:
        process = psutil.Process(robot.pid)
        wait_until_simulated(robot, WARM)
        before, began, simulated = process.memory_info().rss, time.monotonic(), simulated_time(robot)
        passed = wait_until_simulated(robot, simulated + length) - simulated
        took, grown = time.monotonic() - began, process.memory_info().rss - before
    what = f"robot, {passed:,.0f} simulated s"
    yield Row(what, "MB at first", None, before * 1e-6)
    yield at_most(what, "MB more", grown * 1e-6, GROWTH)
    yield Row(what, "x real time", None, passed / took)


@contextmanager
def heard(factor: float) -> Iterator[Program]:
    """A robot in a process of its own, and another process that hears and drives it."""
    domain = reserve_domain()
    with Program("robot_host", factor, domain=domain) as robot, Program("robot_driver", domain=domain) as driver:
        robot.report()
        driver.report()
        time.sleep(SETTLING)
        yield robot


def simulated_time(robot: Program) -> float:
    """The robot's time, in seconds."""
    robot.tell("time")
    return float(robot.report()["time"])


def wait_until_simulated(robot: Program, until: float) -> float:
    """Wait until it is so late in the simulation; return how late it is."""
    while (now := simulated_time(robot)) < until:
        time.sleep(0.1)
    return now


def _work(process: psutil.Process) -> float:
    """Seconds of a core so far."""
    times = process.cpu_times()
    return float(times.user + times.system)
