"""How many students one machine holds: kernels with a turtle, a recording and a check every half minute.

Each student has a ROS domain of their own, as users of a class server have.
"""

from __future__ import annotations

import os
import statistics
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing
from pathlib import Path
from unittest import mock

import psutil  # type: ignore[import-untyped]

from tests.benchmark.table import Row, at_least
from tests.domains import reserve_domain
from tests.grading.handed_in import references
from tests.kernel import Kernel

NOTE = (
    "students: real kernels, each with a turtle, a recording of her pose and the checker, in a domain of its own. "
    "Idle: all processes of a student, nothing is asked. Checks: each student has topics-1 checked every 30 s, at a "
    "moment of their own, with the right answer; seconds from the cell's start to its end."
)
CLASSES = (1, 2, 4, 8, 16, 32)
EXERCISE = "topics-1"
PERIOD = 30.0  # seconds between two checks of a student
CHECK_TIMEOUT = 120.0
BEGIN = """
from rclpy.node import Node
from course_kit import check, record, run
from course_kit import TurtleSim
turtle = run(TurtleSim)
recording = record("/turtle1/pose", keep=1000)
"""
MEMORY = Path("/dev/shm")


class Student:
    """A kernel in its own domain, and how long its checks took."""

    def __init__(self, state: str) -> None:
        own = {"ROS_DOMAIN_ID": str(reserve_domain()), "XDG_STATE_HOME": state}
        with mock.patch.dict(os.environ, own):
            self.kernel = Kernel()
        self.took: list[float] = []
        self.right = 0
        self.pid = int(self.kernel.text(self.kernel.run("import os; print(os.getpid())", 60.0)))
        self.kernel.run(BEGIN, 60.0)
        self.kernel.run(references("topics")[EXERCISE], 60.0)
        self.check()  # so that the checker is there, as it is for a student at work
        self.took.clear()
        self.right = 0

    def check(self) -> None:
        began = time.monotonic()
        cell = self.kernel.run(f"check({EXERCISE!r})", CHECK_TIMEOUT)
        self.took.append(time.monotonic() - began)
        self.right += "2 of 2 points" in self.kernel.text(cell)

    def check_on(self, first: float, end: float) -> None:
        """Check every PERIOD seconds from a moment on, to another."""
        due = first
        while due < end:
            time.sleep(max(0.0, due - time.monotonic()))
            self.check()
            due = max(due + PERIOD, time.monotonic())

    def processes(self) -> list[psutil.Process]:
        kernel = psutil.Process(self.pid)
        return [kernel, *kernel.children(recursive=True)]

    def close(self) -> None:
        self.kernel.close()


def rows(quick: bool) -> Iterator[Row]:
    """All rows of this section."""
    for count in CLASSES[:2] if quick else CLASSES:
        print(f"students: {count}", file=sys.stderr)
        yield from a_class(count, 5.0 if quick else 20.0, PERIOD if quick else 2 * PERIOD)


def a_class(count: int, idle: float, working: float) -> Iterator[Row]:
    """What so many students cost while they are idle for some seconds, and while they work."""
    shared = shared_memory_in_use()
    with ExitStack() as ends:
        state = ends.enter_context(tempfile.TemporaryDirectory())
        students: list[Student] = []
        try:
            for _ in range(count):
                students.append(ends.enter_context(closing(Student(state))))
        except (RuntimeError, AssertionError) as error:  # no answer in time: the machine is full
            print(f"students: {error}", file=sys.stderr)
            yield at_least(
                f"{count} students: at work before the machine was full", f"of {count}", len(students), count
            )
            return
        time.sleep(3.0)
        before = _cpu(students)
        time.sleep(idle)
        idle_percent = 100 * (_cpu(students) - before) / idle / count
        psutil.cpu_percent()
        began = time.monotonic()
        threads = [
            threading.Thread(target=one.check_on, args=(began + PERIOD * number / count, began + working))
            for number, one in enumerate(students)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        busy = psutil.cpu_percent()
        megabytes = sum(each.memory_full_info().pss for one in students for each in one.processes()) * 1e-6
        shared = shared_memory_in_use() - shared
        took = sorted(seconds for one in students for seconds in one.took)
        right = sum(one.right for one in students)
    yield Row(f"{count} students: CPU of an idle one", "% of a core", course=idle_percent)
    yield Row(f"{count} students: processors in use while they check", "%", course=busy)
    yield Row(f"{count} students: memory each", "MB", course=megabytes / count)
    yield Row(f"{count} students: shared memory each", "MB", course=shared * 1e-6 / count)
    yield Row(f"{count} students: a check, median", "s", course=statistics.median(took))
    yield Row(f"{count} students: a check, slowest", "s", course=took[-1])
    yield at_least(f"{count} students: checks with all points", f"of {len(took)}", right, len(took))


def _cpu(students: list[Student]) -> float:
    return sum(sum(each.cpu_times()[:2]) for one in students for each in one.processes())


def shared_memory_in_use() -> int:
    """Bytes of shared memory that are taken, whoever has them."""
    space = os.statvfs(MEMORY)
    return (space.f_blocks - space.f_bfree) * space.f_frsize
