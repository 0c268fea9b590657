"""Callbacks that do not return: which, since when, and where they are."""

from __future__ import annotations

import gc
import linecache
import sys
import threading
import time
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

LONG = 5.0  # seconds that a callback may take before anything is said
_looks = threading.Lock()


@dataclass
class Stall:
    """A callback that runs, as it was seen first."""

    began: FrameType  # kept, so that no other frame gets its place in memory
    since: float  # seconds since the epoch
    place: str  # where it is now

    @property
    def clock(self) -> str:
        """Since when."""
        return time.strftime("%H:%M:%S", time.localtime(self.since))

    @property
    def is_long(self) -> bool:
        """True if it takes so long that it should be said."""
        return time.time() - self.since >= LONG


def look(thread: threading.Thread, before: Stall | None) -> Stall | None:
    """The callback that runs in a thread, where `before` is what was seen at the last look; None if none runs."""
    from course_kit.ros.causes.frames import is_library, is_plumbing  # looks for all of Python's folders

    frame = _frame_of(thread)
    own: list[FrameType] = []
    while frame is not None:
        path = Path(frame.f_code.co_filename)
        if not (is_plumbing(path) or is_library(path)):
            own.append(frame)
        frame = frame.f_back
    if not own:
        return None
    now, began = own[0], own[-1]
    number = now.f_lineno or now.f_code.co_firstlineno  # an instruction may belong to no line
    line = linecache.getline(now.f_code.co_filename, number).strip()
    place = f"line {number} of {now.f_code.co_name}: {line}"
    since = before.since if before is not None and before.began is began else time.time()
    return Stall(began, since, place)


def _frame_of(thread: threading.Thread) -> FrameType | None:
    """Where a thread is now; None if it has ended.

    No garbage is collected meanwhile. Before Python 3.12 that could happen while the list of threads is locked, and run
    callbacks written in Python; a thread that then begins another waits for the list with Python's lock, for ever.
    """
    with _looks:
        collects = gc.isenabled()
        gc.disable()
        try:
            return sys._current_frames().get(thread.ident or 0)
        finally:
            if collects:
                gc.enable()
