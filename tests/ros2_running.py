"""A `ros2` command line that goes on: read as it writes, interrupted when something has been seen."""

from __future__ import annotations

import contextlib
import os
import queue
import signal
import subprocess
import threading
import time
from types import TracebackType

from tests.ros2_command import COMMAND, TIMEOUT, Outcome


class Running:
    """`with Running("topic", "echo", "/chatter") as echo`: what it writes is gathered in the background."""

    def __init__(self, *words: str, stdin: str | None = None) -> None:
        self._began = time.monotonic()
        self._process = subprocess.Popen(
            [*COMMAND, *words],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=os.environ | {"COLUMNS": "80"},
        )
        self._news: queue.Queue[None] = queue.Queue()
        self._out: list[str] = []
        self._err: list[str] = []
        self._threads = [
            threading.Thread(target=self._gather, args=pair, daemon=True)
            for pair in ((self._process.stdout, self._out), (self._process.stderr, self._err))
        ]
        for thread in self._threads:
            thread.start()
        assert self._process.stdin is not None
        if stdin is not None:
            self._process.stdin.write(stdin)
        self._process.stdin.close()

    def _gather(self, stream: object, lines: list[str]) -> None:
        with contextlib.suppress(ValueError):  # it was closed
            for line in stream:  # type: ignore[attr-defined]
                lines.append(line)
                self._news.put(None)

    @property
    def out(self) -> str:
        return "".join(self._out)

    @property
    def err(self) -> str:
        return "".join(self._err)

    def until(self, text: str, count: int = 1) -> None:
        """Wait until it has written a text so many times."""
        deadline = time.monotonic() + TIMEOUT
        while (self.out + self.err).count(text) < count:
            assert time.monotonic() < deadline, f"{text!r} did not come. It wrote:\n{self.out}{self.err}"
            assert self._process.poll() is None or any(t.is_alive() for t in self._threads), (
                f"ended without {text!r}. It wrote:\n{self.out}{self.err}"
            )
            try:
                self._news.get(timeout=0.1)
            except queue.Empty:
                continue

    def interrupt(self) -> None:
        self._process.send_signal(signal.SIGINT)

    def stop_reading(self) -> None:
        """Close the pipe that it writes to."""
        assert self._process.stdout is not None
        self._process.stdout.close()

    def end(self, timeout: float = TIMEOUT) -> Outcome:
        """Wait for its end, or TimeoutExpired."""
        status = self._process.wait(timeout)
        for thread in self._threads:
            thread.join(TIMEOUT)
        return Outcome(self.out, self.err, status, time.monotonic() - self._began)

    def __enter__(self) -> Running:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._process.poll() is None:
            self._process.kill()
            self._process.wait()
