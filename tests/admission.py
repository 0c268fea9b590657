"""When a group of tests that needs a processor begins in a run of several workers: while one has none.

Nodes, simulators and browsers need a processor as long as they live, and on a busy machine they live longer. So one
group too many makes all others longer, and what a busy robot does wrong then says nothing about the course. But such a
group waits as well, for a kernel or a download: while processors idle meanwhile, one more begins.
"""

from __future__ import annotations

import os
import socket
import time
from collections import deque
from collections.abc import Callable, Collection

import psutil  # type: ignore[import-untyped]

from tests.locks import lock

LOOK = 0.25  # seconds from one look at the processors to the next
LOOKS = 12  # over which idle time is counted
IDLE = 0.5  # processors that idle on the average, for one more group
PROCESSORS = os.cpu_count() or 1


def idle_seconds() -> float:
    """Seconds that the processors have had nothing to do since the machine's start, all of them together."""
    times = psutil.cpu_times()
    return float(times.idle + times.iowait)


class Admission:
    """A worker's part: of the groups that are bound to a processor as many run at once as there are processors.

    `run` names the run for all its workers, `bound` are those groups. A group that waits does so until another one
    ends, which the time-outs of tests see to, or until processors idle, by `idle`; the others wait for nobody.
    """

    def __init__(self, run: str, bound: Collection[str], idle: Callable[[], float] = idle_seconds) -> None:
        self._run = run
        self._bound = bound
        self._idle = idle
        self._group = ""
        self._processor: socket.socket | None = None

    def begin(self, group: str) -> None:
        """Wait until a group may begin; do nothing if it has begun."""
        if group == self._group:
            return
        self.end()
        self._group = group
        if group not in self._bound:
            return
        looks: deque[tuple[float, float]] = deque(maxlen=LOOKS + 1)
        while not self._take(PROCESSORS + self._some_idle(looks)):
            time.sleep(LOOK)

    def end(self) -> None:
        """Let others begin."""
        self._group = ""
        if self._processor:
            self._processor.close()
            self._processor = None

    def _some_idle(self, looks: deque[tuple[float, float]]) -> bool:
        """Look at the processors once more; True if they have idled at the last LOOKS."""
        looks.append((time.monotonic(), self._idle()))
        (since, before), (now, after) = looks[0], looks[-1]
        return len(looks) > LOOKS and after - before > IDLE * (now - since)

    def _take(self, places: int) -> bool:
        free = (lock(f"course-kit-test-run-{self._run}-processor-{number}") for number in range(places))
        self._processor = next((one for one in free if one), None)
        return self._processor is not None
