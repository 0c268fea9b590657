"""Keys that are pressed while `ros2 bag` records or plays in a terminal, read one by one and without waiting."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

from course_kit.base.keyboard import Keyboard

NO_TERMINAL = "stdin is not a terminal device. Keyboard handling disabled."


@contextmanager
def keys(are_wanted: bool) -> Iterator[Callable[[], str | None]]:
    """While the block runs, what gives the key that was pressed since the last look, or None; see Keyboard.read()."""
    terminal = _terminal() if are_wanted else None
    if terminal is None:
        yield lambda: None
        return
    with Keyboard(terminal) as keyboard:

        def pressed() -> str | None:
            with suppress(EOFError):  # what goes on does so without its terminal too
                return keyboard.read(0.0)
            return None

        yield pressed


def _terminal() -> int | None:
    """The terminal that keys come from, if there is one that this process may read."""
    with suppress(OSError, ValueError, AttributeError):  # AttributeError where there is no stdin at all
        terminal = sys.stdin.fileno()
        if os.isatty(terminal):  # in the background it would stop this process
            return terminal if os.tcgetpgrp(terminal) == os.getpgrp() else None
    print(NO_TERMINAL, end="", file=sys.stderr, flush=True)  # without an end of line, as rosbag2 does
    return None
