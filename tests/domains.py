"""ROS domains for test processes: each gets one that no other test process of this machine uses."""

from __future__ import annotations

import contextlib
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

_locks: list[socket.socket] = []  # kept open as long as the process lives


def reserve_domain() -> int:
    """A domain of one's own: 2 to 101, the range without port clashes. RuntimeError when all are taken.

    It is taken by a socket with the domain's name, which has no file and goes with its process.
    """
    start = os.getpid() % 100
    for step in range(100):
        domain = 2 + (start + step) % 100
        lock = socket.socket(socket.AF_UNIX)
        with contextlib.suppress(OSError):  # another test process has it
            lock.bind(f"\0course-kit-test-domain-{domain}")
            _locks.append(lock)
            return domain
        lock.close()
    raise RuntimeError("100 test processes run already: no ROS domain is left")


@contextmanager
def own_domain() -> Iterator[int]:
    """A ROS domain without the nodes that other tests of this process have left."""
    domain = reserve_domain()
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(domain))
        yield domain


def use_own_domain() -> int:
    """Put this process and its children into a domain of their own, on this machine only; return the domain."""
    domain = reserve_domain()
    os.environ["ROS_DOMAIN_ID"] = str(domain)
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    os.environ.pop("ROS_LOCALHOST_ONLY", None)
    return domain
