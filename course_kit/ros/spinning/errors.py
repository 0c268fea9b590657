"""Errors of callbacks: kept, counted and described, as data."""

from __future__ import annotations

import threading
import time
import traceback
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from course_kit.ros.causes import with_cause

KEPT = 200


@dataclass
class CallbackError:
    """An exception that a callback raised, and how often it did so in a row."""

    node: str
    exception: Exception
    when: float = field(default_factory=time.time)  # seconds since the epoch, the last time
    count: int = 1

    @property
    def frames(self) -> list[traceback.FrameSummary]:
        """The student's part of the traceback: without rclpy and the course's own frames."""
        from course_kit.ros.causes.frames import is_plumbing  # looks for all of Python's folders

        frames = traceback.extract_tb(self.exception.__traceback__)
        own = [f for f in frames if not is_plumbing(Path(f.filename))]
        return own or [f for f in frames if not _is_of_executors(Path(f.filename))]

    @property
    def title(self) -> str:
        """One line: type and text of the exception."""
        return "".join(traceback.format_exception_only(type(self.exception), self.exception)).strip()

    def __str__(self) -> str:
        where = [f"    line {f.lineno} in {f.name}: {f.line}" for f in self.frames]
        times = f" ({self.count} times)" if self.count > 1 else ""
        text = "\n".join([f"a callback of {self.node} raised {self.title}{times}", *where])
        return with_cause(text, self.exception)

    @property
    def place(self) -> tuple[Any, ...]:
        """What it has in common with others of the same type that the same line of the same node raised."""
        return self.node, type(self.exception), [(f.filename, f.lineno) for f in self.frames[-1:]]


KIT = Path(__file__).parents[2]
EXECUTORS = [KIT / room for room in ("lab/background", "ros/private_api", "ros/spinning")]


def _is_of_executors(path: Path) -> bool:
    """Return True if it is what calls a callback: of the course's own nodes that is all that is left out."""
    return "rclpy" in path.parts or path.parent in EXECUTORS


# Nodes of this process, whose errors are reported here.
reporting: set[str] = set()
_errors: deque[CallbackError] = deque(maxlen=KEPT)
listeners: set[Callable[[CallbackError], None]] = set()  # called, in the executor's thread, with each error
_lock = threading.Lock()


def report(node: str, exception: Exception) -> None:
    """Keep an exception of a node's callback and tell the listeners."""
    error = CallbackError(node, exception)
    with _lock:
        last = next((e for e in reversed(_errors) if e.node == node), None)
        if last is not None and last.place == error.place:
            last.count, last.when, last.exception = last.count + 1, error.when, exception
            error = last
        else:
            _errors.append(error)
    for listener in list(listeners):
        listener(error)


def errors(node: str | None = None) -> list[CallbackError]:
    """The errors kept, oldest first; of one node if its full name is given."""
    with _lock:
        return [e for e in _errors if node is None or e.node == node]


def clear(node: str | None = None) -> None:
    """Forget the errors, or those of one node."""
    with _lock:
        kept = [e for e in _errors if node is not None and e.node != node]
        _errors.clear()
        _errors.extend(kept)
