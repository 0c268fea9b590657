"""When a long group of tests begins in a run of several workers: while the processors have room for it.

Nodes, simulators and browsers need a processor as long as they live, and on a busy machine they live longer. So one
group too many makes all others longer, and what a busy robot does wrong then says nothing about the course.
"""

from __future__ import annotations

import os
import socket
import time
from collections.abc import Mapping

import psutil  # type: ignore[import-untyped]

from tests.locks import lock

LONG = 10.0  # seconds of a group that waits for room
ROOM = 20.0  # percent of the processors' time that is free where there is room
LOOK = 1.0  # seconds in which that is measured
PATIENCE = 120.0  # seconds after which a group begins all the same, as where others keep the machine busy


class Admission:
    """A worker's part: it has its next group wait until as many long ones run as there are processors, or for room.

    `run` names the run for all its workers, `seconds` says how long groups take.
    """

    def __init__(self, run: str, seconds: Mapping[str, float]) -> None:
        self._run = run
        self._seconds = seconds
        self._group = ""
        self._place: socket.socket | None = None  # of one of as many groups as there are processors

    def begin(self, group: str) -> None:
        """Wait until a group may begin; do nothing if it has begun."""
        if group == self._group:
            return
        self.end()
        self._group = group
        if self._seconds.get(group, 0.0) >= LONG:
            self._wait()

    def end(self) -> None:
        """Let others begin."""
        self._group = ""
        if self._place:
            self._place.close()
            self._place = None

    def _wait(self) -> None:
        until = time.monotonic() + PATIENCE
        while not self._place and time.monotonic() < until:
            places = (self._lock(f"place-{number}") for number in range(os.cpu_count() or 1))
            self._place = next((place for place in places if place), None)
            if not self._place and self._finds_room():
                return

    def _finds_room(self) -> bool:
        """Measure whether there is room; one worker at a time does, so each sees the group that began before."""
        if looks := self._lock("look"):
            with looks:
                return bool(psutil.cpu_times_percent(LOOK).idle >= ROOM)
        time.sleep(LOOK / 4)
        return False

    def _lock(self, name: str) -> socket.socket | None:
        return lock(f"course-kit-test-run-{self._run}-{name}")
