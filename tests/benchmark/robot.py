"""The robot with physics as a process of its own, heard by another one: what it takes of a core, how it hurries."""

from __future__ import annotations

import time
from collections.abc import Iterator

import psutil  # type: ignore[import-untyped]

from tests.benchmark.child import Program
from tests.benchmark.table import Row, at_least, at_most
from tests.domains import reserve_domain

NOTE = (
    "robot: run(Robot) in a process that does nothing else, in the world rooms; another one hears all its topics and "
    "drives it in a circle. Of a core: what the robot's process takes. Hurried: simulated seconds a second at factor 0."
)
SETTLING = 2.0  # s after the first message


def rows(quick: bool) -> Iterator[Row]:
    """All rows of this section."""
    seconds = 2.0 if quick else 10.0
    for factor, what in ((1, "at real time"), (5, "at factor 5"), (0, "hurried")):
        domain = reserve_domain()
        with (
            Program("robot_host", factor, domain=domain) as robot,
            Program("robot_driver", domain=domain) as driver,
        ):
            robot.report()
            driver.report()
            time.sleep(SETTLING)
            process = psutil.Process(robot.pid)
            before, began = _work(process), time.monotonic()
            robot.tell("time")
            simulated = robot.report()["time"]
            time.sleep(seconds)
            robot.tell("time")
            passed = robot.report()["time"] - simulated
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


def _work(process: psutil.Process) -> float:
    """Seconds of a core so far."""
    times = process.cpu_times()
    return float(times.user + times.system)
