"""A grader's checker: examines what the grader says and when, and tells the verdict to nobody else.

The notebook's kernel reaches it at a socket, by which it asks for its check and obeys the checker's orders. What it
says there is forwarded while the exercise is examined whose check cell runs, once; all else is refused.
"""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Mapping
from multiprocessing.connection import Listener
from pathlib import Path

from course_kit.checking.client import GRACE, START_TIMEOUT, CheckerProcess
from course_kit.examining.channel import Channel, Closed, Message, TooLong
from course_kit.examining.verdict import Verdict

NOT_NOW = "the grader has this exercise checked once, when its check cell runs"


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
        self._deadline = 0.0
        self._verdict: Verdict | None = None
        self._examined = threading.Event()
        for work in (self._accept, self._read_checker):
            threading.Thread(target=work, daemon=True).start()

    def begin(self, exercise: str) -> None:
        """Its check cell begins to run."""
        with self._lock:
            self._now, self._is_asked, self._verdict = exercise, False, None
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
    def is_stuck(self) -> bool:
        """Whether the checker still examines what should have ended."""
        return self._is_asked and not self._examined.is_set()

    def close(self) -> None:
        """End the checker."""
        with contextlib.suppress(OSError):
            self._listener.close()
        self._checker.close(patience=2.0)

    def _accept(self) -> None:
        with contextlib.suppress(OSError):
            while True:
                channel = Channel(self._listener.accept())
                threading.Thread(target=self._read_kernel, args=(channel,), daemon=True).start()

    def _read_kernel(self, kernel: Channel) -> None:
        with contextlib.suppress(Closed, TooLong):
            while True:
                message = kernel.receive()
                if message is None:
                    continue
                if "answer" in message:
                    if kernel is self._kernel:
                        self._checker.channel.send(message)
                elif question := self._question(kernel, message):
                    self._checker.channel.send(question)
                else:
                    kernel.send({"refused": NOT_NOW})

    def _question(self, kernel: Channel, message: Message) -> Message | None:
        """What the checker is asked for a kernel; None if it is not the time for it."""
        with self._lock:
            exercise = message.get("check")
            if not self._now or exercise != self._now or self._is_asked:
                return None
            self._kernel, self._is_asked = kernel, True
            self._deadline = time.monotonic() + START_TIMEOUT
        # The checker draws the seed: not one that an answer has chosen.
        return {"check": exercise, "value": message.get("value"), "folder": str(self._folder)}

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
            self._examined.set()
            message = {"graded": verdict.exercise, "title": verdict.title}
        elif "refused" in message:
            self._examined.set()
        if self._kernel is not None:
            self._kernel.send(message)
