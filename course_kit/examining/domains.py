"""A ROS domain of the checker's own: the stage, on which a student's class meets only what its exercise is about.

Standard library only.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import IO

# Above the domains of users (1 to 100), with ports that Linux does not give to other programs.
STAGES = range(215, 233)
RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"

_locks: list[IO[str]] = []  # kept open as long as the process lives


def reserve_stage() -> int:
    """A domain that no other checker of this machine uses. RuntimeError when all are taken."""
    folder = Path(tempfile.gettempdir(), "course-kit-stages")
    folder.mkdir(mode=0o1777, exist_ok=True)
    with contextlib.suppress(OSError):  # of another user, who has done it
        folder.chmod(0o1777)
    for domain in STAGES:
        try:
            descriptor = os.open(folder / str(domain), os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
        except OSError:  # another user's, and the system protects files of others in such folders
            continue
        lock = os.fdopen(descriptor, "w")
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            lock.close()
            continue
        _locks.append(lock)
        return domain
    raise RuntimeError(f"{len(STAGES)} checkers run on this machine already; try again when one of them has ended")


@contextlib.contextmanager
def on_this_machine() -> Iterator[None]:
    """Contexts that are made inside speak with this machine only, also where the user has opened theirs."""
    before = {name: os.environ.pop(name, None) for name in (RANGE, "ROS_LOCALHOST_ONLY", "ROS_STATIC_PEERS")}
    os.environ[RANGE] = "LOCALHOST"
    try:
        yield
    finally:
        del os.environ[RANGE]
        os.environ.update({name: value for name, value in before.items() if value is not None})
