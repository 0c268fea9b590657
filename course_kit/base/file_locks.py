"""Locks between processes, waited for with a time-out. Pure: no ROS."""

from __future__ import annotations

import contextlib
import fcntl
from collections.abc import Iterator
from pathlib import Path

from course_kit.base.atomic_files import writing
from course_kit.base.polling import wait_until


class LockTimeout(OSError):  # noqa: N818  (reads as what happened)
    """Another process keeps a lock; the text says which, and what to do."""


@contextlib.contextmanager
def locked(file: Path, timeout: float) -> Iterator[None]:
    """Hold the lock of a file, which is made if need be, in the block.

    Raises LockTimeout if another process has it for `timeout` seconds, NotWritten where the file cannot be made.
    """
    with contextlib.ExitStack() as stack:
        with writing(file):
            file.parent.mkdir(parents=True, exist_ok=True)
            lock = stack.enter_context(file.open("w"))
        if not wait_until(lambda: acquire(lock.fileno()), timeout):
            raise LockTimeout(
                f"another process has kept the lock '{file}' for {timeout:g} s. `fuser '{file}'` names it: end that one"
            )
        yield


def acquire(descriptor: int) -> bool:
    """Take the lock of an open file or folder without waiting; whether that was possible."""
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        return True
    except BlockingIOError:
        return False
