"""When a group of tests that needs a processor begins in a run of several workers: while one has none.

Nodes, simulators and browsers need a processor as long as they live, and on a busy machine they live longer. So one
group too many makes all others longer, and what a busy robot does wrong then says nothing about the course.
"""

from __future__ import annotations

import os
import socket
import time
from collections.abc import Collection

from tests.locks import lock

LOOK = 0.25  # seconds from one look at the processors to the next


class Admission:
    """A worker's part: of the groups that are bound to a processor as many run at once as there are processors.

    `run` names the run for all its workers, `bound` are those groups. A group that waits does so until another one
    ends, which the time-outs of tests see to; the others wait for nobody.
    """

    def __init__(self, run: str, bound: Collection[str]) -> None:
        self._run = run
        self._bound = bound
        self._group = ""
        self._processor: socket.socket | None = None

    def begin(self, group: str) -> None:
        """Wait until a group may begin; do nothing if it has begun."""
        if group == self._group:
            return
        self.end()
        self._group = group
        while group in self._bound and not self._take():
            time.sleep(LOOK)

    def end(self) -> None:
        """Let others begin."""
        self._group = ""
        if self._processor:
            self._processor.close()
            self._processor = None

    def _take(self) -> bool:
        free = (lock(f"course-kit-test-run-{self._run}-processor-{number}") for number in range(os.cpu_count() or 1))
        self._processor = next((one for one in free if one), None)
        return self._processor is not None
