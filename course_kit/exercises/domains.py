"""A ROS domain of the checker's own: the stage, on which a student's class meets only what its exercise is about.

Standard library only.
"""

from __future__ import annotations

import contextlib
import socket

# Above the domains of users (1 to 101); first those whose ports Linux does not give to other programs.
STAGES = (*range(215, 233), *range(102, 215))

_locks: list[socket.socket] = []  # kept open as long as the process lives


def reserve_stage() -> int:
    """A domain that no other checker of this machine uses. RuntimeError when all are taken.

    It is taken by a socket with the domain's name, which has no file and goes with its process.
    """
    for domain in STAGES:
        lock = socket.socket(socket.AF_UNIX)
        with contextlib.suppress(OSError):  # another checker has it
            lock.bind(f"\0course-kit-stage-{domain}")
            _locks.append(lock)
            return domain
        lock.close()
    raise RuntimeError(f"{len(STAGES)} checkers run on this machine already; try again when one of them has ended")
