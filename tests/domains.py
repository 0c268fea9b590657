"""ROS domains for test processes: each gets one that no other test process of this machine uses."""

from __future__ import annotations

import fcntl
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

import pytest

_locks: list[IO[str]] = []  # kept open as long as the process lives


def reserve_domain() -> int:
    """A domain of one's own: 2 to 101, the range without port clashes. RuntimeError when all are taken."""
    folder = Path(tempfile.gettempdir(), f"course-kit-test-domains-{os.getuid()}")
    folder.mkdir(exist_ok=True)
    start = os.getpid() % 100
    for step in range(100):
        domain = 2 + (start + step) % 100
        lock = open(folder / str(domain), "w")  # noqa: SIM115
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            lock.close()
            continue
        _locks.append(lock)
        return domain
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
