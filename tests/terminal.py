"""A program in a terminal of its own, in which keys are pressed and what it prints is read."""

from __future__ import annotations

import fcntl
import os
import pty
import select
import subprocess
import termios
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from course_kit.base.polling import wait_until

ROOT = Path(__file__).parents[1]
CTRL_C = b"\x03"
PAUSE = 0.05  # seconds
TIMEOUT = 60.0


class Terminal:
    """Starts a command. A context: in the end it kills what has not ended."""

    def __init__(
        self, command: Sequence[str], environment: dict[str, str] | None = None, is_controlling: bool = True
    ) -> None:
        """`is_controlling`: Ctrl-C interrupts the program, as in a shell. `environment` is added to this process's."""
        self._screen, self._inside = pty.openpty()
        self.before = self.settings()
        self.process = subprocess.Popen(
            command,
            cwd=ROOT,
            env={**os.environ, **(environment or {})},
            stdin=self._inside,
            stdout=self._inside,
            stderr=self._inside,
            start_new_session=is_controlling,
            preexec_fn=(lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0)) if is_controlling else None,
        )
        self._printed = b""
        self._open = [self._inside, self._screen]

    @property
    def text(self) -> str:
        """What was read so far."""
        return self._printed.decode(errors="replace").replace("\r\n", "\n")

    @property
    def has_ended(self) -> bool:
        """True if the program has ended."""
        return self.process.poll() is not None

    def settings(self) -> list[Any]:
        """How the terminal treats keys, as termios has it."""
        return termios.tcgetattr(self._inside)

    def wait_for(self, text: str, count: int = 1) -> None:
        """Read until a text was printed so many times. AssertionError with what was printed if it was not."""
        wait_until(lambda: self.text.count(text) >= count or self.has_ended, TIMEOUT, pause=self._read)
        self._read_rest()
        assert self.text.count(text) >= count, f"no {text!r} in {self.text}"

    def press(self, keys: bytes) -> None:
        """Press keys."""
        os.write(self._screen, keys)

    def close(self) -> None:
        """Close the window, so to say."""
        self._open.remove(self._screen)
        os.close(self._screen)

    def end(self) -> int:
        """Read until the program has ended by itself; return its exit status."""
        assert wait_until(lambda: self.has_ended, TIMEOUT, pause=self._read), f"no end of {self.text}"
        self._read_rest()
        return int(self.process.returncode)

    def _read(self, timeout: float = PAUSE) -> bool:
        """Read what comes within a time; whether something did."""
        if self._screen not in self._open:
            time.sleep(timeout)
            return False
        is_there = bool(select.select([self._screen], [], [], timeout)[0])
        if is_there:
            self._printed += os.read(self._screen, 65536)
        return is_there

    def _read_rest(self) -> None:
        while self._read(0.0):
            pass

    def __enter__(self) -> Terminal:
        return self

    def __exit__(self, *error: object) -> None:
        if not self.has_ended:
            self.process.kill()
        self.process.wait(TIMEOUT)
        while self._open:
            os.close(self._open.pop())
