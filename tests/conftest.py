"""Each test process gets a ROS domain of its own, on localhost, with the course's discovery profile."""

from __future__ import annotations

import fcntl
import os
import tempfile
from pathlib import Path

_locks = []  # kept open as long as the process lives


def _reserve_domain() -> int:
    """A domain that no other test process of this machine uses: 2 to 101, the range without port clashes."""
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


os.environ["ROS_DOMAIN_ID"] = str(_reserve_domain())
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ.pop("ROS_LOCALHOST_ONLY", None)
