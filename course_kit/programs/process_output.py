"""What a child process writes: read in a thread, cut into lines without a terminal's colours."""

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
        """The lines that are complete now."""
        *complete, self._partial = (self._partial + self._decoder.decode(data)).split("\n")
        return complete

    def rest(self) -> list[str]:
        """What came after the last line end, if anything."""
        partial, self._partial = self._partial + self._decoder.decode(b"", final=True), ""
        return [partial] if partial else []


def as_seen(line: str) -> str:
    """A line as a terminal leaves it: without colours, and only what was written over the rest."""
    return _ESCAPES.sub("", line.rstrip("\r")).rpartition("\r")[2]


class Reader:
    """Hands each line that comes from a file descriptor to `on_line`, and says when there will be no more."""

    def __init__(
        self, fd: int, has_ended: Callable[[], bool], on_line: Callable[[str], None], on_end: Callable[[], None]
    ) -> None:
        """`has_ended` says whether the process has; `on_end` is called once, in the reading thread."""
        self._fd = fd
        self._has_ended = has_ended
        self._on_line = on_line
        self._on_end = on_end
        self._thread = threading.Thread(target=self._run, name="course_kit process output", daemon=True)

    def start(self) -> None:
        """Begin to read."""
        self._thread.start()

    def _run(self) -> None:
        lines = LineCutter()
        for data in self._chunks():
            for line in lines.feed(data):
                self._on_line(line)
        for line in lines.rest():
            self._on_line(line)
        os.close(self._fd)
        self._on_end()

    def _chunks(self) -> Iterator[bytes]:
        deadline = None
        poller = select.poll()  # select() takes no descriptor above 1023
        poller.register(self._fd, select.POLLIN)
        while deadline is None or time.monotonic() < deadline:
            if poller.poll(POLL * 1000):
                data = b""
                with contextlib.suppress(OSError):  # how a terminal tells its end
                    data = os.read(self._fd, CHUNK)
                if not data:
                    return
                yield data
            if deadline is None and self._has_ended():
                deadline = time.monotonic() + PATIENCE
