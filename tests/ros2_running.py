"""A `ros2` command line that goes on: read as it writes, interrupted when something has been seen."""

from __future__ import annotations

import os
import signal
import subprocess
import threading
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import IO

from course_kit.base.polling import wait_until
from tests.ros2_command import COMMAND, LATE, TIMEOUT, Outcome, end


class Running:
    """`with Running("topic", "echo", "/chatter") as echo`: what it writes is gathered in the background."""

    def __init__(
        self,
        *words: str | Path,
        stdin: str = "",
        stderr: int = subprocess.PIPE,
        environment: Mapping[str, str] | None = None,
        own_group: bool = False,
        prepare: Callable[[], None] | None = None,
    ) -> None:
        """`stderr=STDOUT` puts both streams into `out`, in their order; `prepare` runs in the process first."""
        self._began = time.monotonic()
        self.process = subprocess.Popen(
            [*COMMAND, *map(str, words)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=stderr,
            text=True,
            env={**os.environ, "COLUMNS": "80", **(environment or {})},
            start_new_session=own_group,
            preexec_fn=prepare,
        )
        self._out: list[str] = []
        self._err: list[str] = []
        self._reads = True
        self._threads = [
            threading.Thread(target=self._gather, args=pair, daemon=True)
            for pair in ((self.process.stdout, self._out), (self.process.stderr, self._err))
            if pair[0] is not None
        ]
        for thread in self._threads:
            thread.start()
        assert self.process.stdin is not None
        self.process.stdin.write(stdin)
        self.process.stdin.close()

    def _gather(self, stream: IO[str], lines: list[str]) -> None:
        for line in stream:
            if not line.startswith(LATE):
                lines.append(line)
            if stream is self.process.stdout and not self._reads:
                stream.close()
                return

    @property
    def out(self) -> str:
        return "".join(self._out)

    @property
    def err(self) -> str:
        return "".join(self._err)

    @property
    def lines(self) -> list[str]:
        """The lines of `out`."""
        return [line.rstrip("\n") for line in self._out]

    def until(self, text: str, count: int = 1) -> None:
        """Wait until it has written a text so many times."""
        self._wait(lambda: (self.out + self.err).count(text) >= count, text)

    def _wait(self, is_written: Callable[[], bool], what: str) -> None:
        wait_until(lambda: is_written() or not any(thread.is_alive() for thread in self._threads), TIMEOUT)
        assert is_written(), f"no {what!r}, status {self.process.poll()}. It wrote:\n{self.out}{self.err}"

    def interrupt(self) -> None:
        """Send it SIGINT, and no other process."""
        self.process.send_signal(signal.SIGINT)

    def stop_reading(self) -> None:
        """Close our end of the pipe after the next line, as `head` does."""
        self._reads = False

    def end(self, timeout: float = TIMEOUT) -> Outcome:
        """Wait for its end, or TimeoutExpired."""
        status = self.process.wait(timeout)
        for thread in self._threads:
            thread.join(TIMEOUT)
        return Outcome(self.out, self.err, status, time.monotonic() - self._began)

    def __enter__(self) -> Running:
        return self

    def __exit__(self, *_: object) -> None:
        end(self.process)
