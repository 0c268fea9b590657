"""The keys of a terminal, one by one, without waiting for the enter key. No ROS."""

from __future__ import annotations

import contextlib
import os
import re
import select
import termios
import tty

_ARROWS = {b"A": "up", b"B": "down", b"C": "right", b"D": "left"}
_ESCAPE_SEQUENCE = re.compile(rb"\x1b[\[O]([0-?]*)[ -/]*([@-~])")
_PATIENCE = 0.05  # seconds in which the rest of an escape sequence comes


class Keyboard:
    """Reads the terminal behind a file descriptor; as a context manager it leaves the terminal as it was."""

    def __init__(self, terminal: int) -> None:
        self._terminal = terminal
        self._unread = b""

    def __enter__(self) -> Keyboard:
        self._before = termios.tcgetattr(self._terminal)
        tty.setcbreak(self._terminal)  # no echo, no lines; Ctrl-C still interrupts
        return self

    def __exit__(self, *_: object) -> None:
        with contextlib.suppress(termios.error):  # the terminal may be gone
            termios.tcsetattr(self._terminal, termios.TCSADRAIN, self._before)

    def read(self, timeout: float) -> str | None:
        """The next key: "up", "down", "left", "right" or a character; None if none came in `timeout` seconds.

        Raises EOFError when the terminal is gone.
        """
        if not self._unread and not self._more(timeout):
            return None
        while _is_unfinished(self._unread) and self._more(_PATIENCE):
            pass
        key, self._unread = first_key(self._unread)
        return key

    def _more(self, timeout: float) -> bool:
        ready, _, _ = select.select([self._terminal], [], [], timeout)
        if not ready:
            return False
        try:
            read = os.read(self._terminal, 1024)
        except OSError:  # what Linux says when the other end has closed
            read = b""
        if not read:
            raise EOFError("the terminal is gone")
        self._unread += read
        return True


def first_key(typed: bytes) -> tuple[str | None, bytes]:
    """The first key in what was typed, None if it has no name here, and the rest."""
    sequence = _ESCAPE_SEQUENCE.match(typed)
    if sequence is None:
        return typed[:1].decode("ascii", "ignore") or None, typed[1:]
    parameters, final = sequence.groups()
    return (None if parameters else _ARROWS.get(final)), typed[sequence.end() :]


def _is_unfinished(typed: bytes) -> bool:
    return typed.startswith(b"\x1b") and _ESCAPE_SEQUENCE.match(typed) is None and len(typed) < 16
