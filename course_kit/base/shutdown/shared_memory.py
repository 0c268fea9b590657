"""Removes the shared memory that killed processes leave, half a megabyte each with Fast DDS.

Only segments are, which no other process ever opens anew. Ports, which are small, are left to Fast DDS: one that is
looked at while another process takes it into use is refused to that process.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import re
import time
from pathlib import Path

FOLDER = Path("/dev/shm")
LOCK = re.compile(r"fastrtps_[0-9a-f]{16}_el")  # held by the process that made the segment, as long as it lives
NEW = 5.0  # seconds in which a segment is not touched: its maker may not have come to lock it


def tidy() -> None:
    """Remove the segments of this user's processes that are no more."""
    with contextlib.suppress(OSError):  # there is no such folder, or it is not to be read
        for lock in FOLDER.iterdir():
            if LOCK.fullmatch(lock.name):
                with contextlib.suppress(OSError):  # held, another user's, or just removed
                    _remove_if_left(lock)


def _segment(lock: Path) -> Path:
    return lock.with_name(lock.name.removesuffix("_el"))


def _remove_if_left(lock: Path) -> None:
    found = lock.stat()
    if found.st_uid != os.getuid() or time.time() - found.st_mtime < NEW:
        return
    with open(lock) as file:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        _segment(lock).unlink(missing_ok=True)
        lock.unlink()
