"""A grader's checker: examines what the grader says and when, and tells the verdict to nobody else.

The notebook's kernel reaches it at a socket, by which it asks for its check and obeys the checker's orders. What it
says there is forwarded while the exercise is examined whose check cell runs, once; all else is refused.
"""

from __future__ import annotations

import contextlib
import os
import socket
import struct
import threading
import time
from collections.abc import Mapping
from multiprocessing.connection import Connection, Listener
from pathlib import Path

from course_kit.exercises.in_notebook.checker_client import GRACE, START_TIMEOUT, CheckerProcess
from course_kit.exercises.protocol.channel import Channel, Closed, Message, TooLong
from course_kit.exercises.protocol.verdict import Verdict

NOT_NOW = "the grader has this exercise checked once, when its check cell runs"
ASK_TIMEOUT = 30.0  # seconds in which a check cell asks
AFTER = 5.0  # seconds in which it ends after that


class Examiner:
    """The checker of one notebook, and the socket at which the kernel asks it."""

    def __init__(self, address: str, folder: Path, additions: Mapping[str, str]) -> None:
        """`folder` is the notebook's; `additions` to the checker's environment."""
        self._folder = folder
        self._listener = Listener(address, "AF_UNIX", backlog=16)
        self._checker = CheckerProcess(None, additions)
        self._lock = threading.Lock()
        self._kernel: Channel | None = None  # the one that asked
        self._now = ""  # the exercise whose check cell runs
        self._is_asked = False
        self._deadline = 0.0  # until which it asks, or is answered
        self._verdict: Verdict | None = None
        self._examined = threading.Event()
        for work in (self._accept, self._read_checker):
            threading.Thread(target=work, daemon=True).start()

    def begin(self, exercise: str) -> None:
        """Its check cell begins to run."""
        with self._lock:
            self._now, self._is_asked, self._verdict = exercise, False, None
            self._deadline = time.monotonic() + ASK_TIMEOUT
            self._examined.clear()

    def end(self) -> Verdict | None:
        """The verdict on the exercise whose check cell has run; None if the kernel did not ask for it."""
        while self._is_asked and (left := self._deadline - time.monotonic()) > 0:
            if self._examined.wait(min(left, 1.0)):
                break
        with self._lock:
            self._now = ""
            return self._verdict

    @property
    def is_over(self) -> bool:
        """True if nothing more is to be waited for: no question came, or its answer is there for a while."""
        with self._lock:
            return time.monotonic() > self._deadline and (self._examined.is_set() or not self._is_asked)

    @property
    def is_stuck(self) -> bool:
        """True if the checker still examines what should have ended."""
        return self._is_asked and not self._examined.is_set()

    def close(self) -> None:
        """End the checker."""
        with contextlib.suppress(OSError):
            self._listener.close()
        self._checker.close(patience=2.0)

    def _accept(self) -> None:
        with contextlib.suppress(OSError):
            while True:
                end = self._listener.accept()
                threading.Thread(target=self._read_kernel, args=(Channel(end), _peer(end)), daemon=True).start()

    def _read_kernel(self, kernel: Channel, pid: int) -> None:
        with contextlib.closing(kernel), contextlib.suppress(Closed, TooLong):
            while True:
                message = kernel.receive()
                if message is None:
                    continue
                if "answer" in message:
                    if kernel is self._kernel:
                        self._checker.channel.send(message)
                elif question := self._question(kernel, pid, message):
                    self._checker.channel.send(question)
                else:
                    kernel.send({"refused": NOT_NOW})

    def _question(self, kernel: Channel, pid: int, message: Message) -> Message | None:
        """What the checker is asked for a kernel; None if it is not the time for it."""
        with self._lock:
            exercise = message.get("check")
            if not self._now or exercise != self._now or self._is_asked:
                return None
            self._kernel, self._is_asked = kernel, True
            self._deadline = time.monotonic() + START_TIMEOUT
        # The checker draws the seed: not one that an answer has chosen.
        return {"check": exercise, "value": message.get("value"), "folder": str(self._folder), "pid": pid}

    def _read_checker(self) -> None:
        with contextlib.suppress(Closed):
            while True:
                message = self._checker.channel.receive()
                if message is not None:
                    with contextlib.suppress(Closed, TooLong):
                        self._take(message)
        self._examined.set()

    def _take(self, message: Message) -> None:
        """Keep a verdict; let the kernel have everything else."""
        if "begun" in message:
            self._deadline = time.monotonic() + float(message["begun"]) + GRACE
        if "verdict" in message:
            verdict = Verdict.from_json(message["verdict"])
            with self._lock:
                if verdict.exercise == self._now:
                    self._verdict = verdict
            message = {"graded": verdict.exercise, "title": verdict.title}
        if "graded" in message or "refused" in message:
            with self._lock:
                self._deadline = time.monotonic() + AFTER
                self._examined.set()
        if self._kernel is not None:
            self._kernel.send(message)


def _peer(end: Connection) -> int:
    """The process at the other end, as the machine tells it."""
    credentials = struct.Struct("3i")  # its id, its user's, its group's
    with socket.socket(fileno=os.dup(end.fileno())) as same:
        told = same.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, credentials.size)
    return int(credentials.unpack(told)[0])
