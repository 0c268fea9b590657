"""Keys that are pressed while `ros2 bag` records or plays in a terminal, read one by one and without waiting."""

from __future__ import annotations

import os
import select
import sys
import termios
import tty
from types import TracebackType
from typing import Any

SPACE, RIGHT, UP, DOWN = "SPACE", "CURSOR_RIGHT", "CURSOR_UP", "CURSOR_DOWN"
SEQUENCES = {b" ": SPACE, b"\x1b[C": RIGHT, b"\x1b[A": UP, b"\x1b[B": DOWN}
NO_TERMINAL = "stdin is not a terminal device. Keyboard handling disabled."


class Keys:
    """Takes keys from the terminal while its `with` block runs, if there is a terminal and they are wanted."""

    def __init__(self, are_wanted: bool) -> None:
        self._are_wanted = are_wanted
        self._settings: list[Any] | None = None
        self._input = -1

    def __enter__(self) -> Keys:
        if not self._are_wanted:
            return self
        try:
            self._input = sys.stdin.fileno()
            if not os.isatty(self._input):
                raise OSError
        except (OSError, ValueError, AttributeError):  # AttributeError where there is no stdin at all
            print(NO_TERMINAL, end="", file=sys.stderr, flush=True)  # without an end of line, as rosbag2 does
            return self
        if os.tcgetpgrp(self._input) == os.getpgrp():  # in the background the terminal would stop this process
            self._settings = termios.tcgetattr(self._input)
            tty.setcbreak(self._input, termios.TCSANOW)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        if self._settings is not None:
            termios.tcsetattr(self._input, termios.TCSANOW, self._settings)
            self._settings = None

    def pressed(self) -> str | None:
        """The key that was pressed since the last look, None if there was none that means something here."""
        if self._settings is None or not select.select([self._input], [], [], 0)[0]:
            return None
        return SEQUENCES.get(os.read(self._input, 8))
