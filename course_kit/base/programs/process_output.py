"""Reads the output of a child process in a thread, and cuts it into lines without a terminal's colours."""

from __future__ import annotations

import codecs
import contextlib
import os
import pty
import re
import select
import termios
import threading
import time
from collections.abc import Callable, Iterator

CHUNK = 65536
POLL = 0.1  # seconds between two looks at whether the process has ended
# Output that grandchildren hold open is not waited for longer than this once the process has ended.
PATIENCE = 0.5
LONGEST_LINE = 1_000_000  # characters; a longer one is cut
_ESCAPES = re.compile(r"\x1b\[[0-?]*[ -/]*[@-~]|\x1b\][^\x07\x1b]*(?:\x07|\x1b\\)|\x1b[@-Z\\-_]")


def open_terminal() -> tuple[int, int]:
    """A pseudo-terminal as (our end, the process's end), for programs to write each line at once; else a pipe."""
    try:
        ours, theirs = pty.openpty()
    except OSError:  # no /dev/pts here, or all are taken
        return os.pipe()
    attributes = termios.tcgetattr(theirs)
    attributes[1] &= ~termios.OPOST  # no carriage returns
    attributes[3] &= ~termios.ECHO
    termios.tcsetattr(theirs, termios.TCSANOW, attributes)
    return ours, theirs


class LineCutter:
    """Bytes in, lines out, without their newlines."""

    def __init__(self) -> None:
        self._decoder = codecs.getincrementaldecoder("utf-8")("replace")
        self._partial = ""

    def feed(self, data: bytes) -> list[str]:
        """The lines that are complete now, or as long as a line may be."""
        *complete, self._partial = (self._partial + self._decoder.decode(data)).split("\n")
        if len(self._partial) > LONGEST_LINE:
            complete.append(self._partial)
            self._partial = ""
        return complete

    def rest(self) -> list[str]:
        """What came after the last line end, if anything."""
        partial, self._partial = self._partial + self._decoder.decode(b"", final=True), ""
        return [partial] if partial else []


def as_seen(line: str) -> str:
    """A line as a terminal leaves it: without colours, and only what was written over the rest."""
    return _ESCAPES.sub("", line.rstrip("\r")).rpartition("\r")[2]


def read_lines(
    fd: int, has_ended: Callable[[], bool], on_line: Callable[[str], None], on_end: Callable[[], None]
) -> None:
    """Hand each line that comes from a file descriptor to `on_line`, in a thread; there call `on_end` in the end.

    `has_ended` says whether the process has.
    """

    def run() -> None:
        lines = LineCutter()
        for data in _chunks(fd, has_ended):
            for line in lines.feed(data):
                on_line(line)
        for line in lines.rest():
            on_line(line)
        os.close(fd)
        on_end()

    threading.Thread(target=run, name="course_kit process output", daemon=True).start()


def _chunks(fd: int, has_ended: Callable[[], bool]) -> Iterator[bytes]:
    deadline = None
    poller = select.poll()  # select() takes no descriptor above 1023
    poller.register(fd, select.POLLIN)
    while deadline is None or time.monotonic() < deadline:
        if poller.poll(POLL * 1000):
            data = b""
            with contextlib.suppress(OSError):  # how a terminal tells its end
                data = os.read(fd, CHUNK)
            if not data:
                return
            yield data
        if deadline is None and has_ended():
            deadline = time.monotonic() + PATIENCE
