"""The test domain: a ROS domain of the checker's own, in which a student's class meets only what its exercise needs.

Standard library only.
"""

from __future__ import annotations

import contextlib
import socket

# Above the domains of users (1 to 101); first those whose ports Linux does not give to other programs.
TEST_DOMAINS = (*range(215, 233), *range(102, 215))

_locks: list[socket.socket] = []  # kept open as long as the process lives


def reserve_domain() -> int:
    """A domain that no other checker of this machine uses. RuntimeError when all are taken.

    It is taken by a socket with the domain's name, which has no file and goes with its process.
    """
    for domain in TEST_DOMAINS:
        lock = socket.socket(socket.AF_UNIX)
        with contextlib.suppress(OSError):  # another checker has it
            lock.bind(f"\0course-kit-stage-{domain}")
            _locks.append(lock)
            return domain
        lock.close()
    raise RuntimeError(
        f"{len(TEST_DOMAINS)} checkers run on this machine already; try again when one of them has ended"
    )
