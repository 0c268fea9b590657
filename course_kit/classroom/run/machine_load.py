"""The share of a time span in which processes of this machine waited for a processor. Standard library only."""

from __future__ import annotations

import os
import time
from pathlib import Path

PRESSURE = Path("/proc/pressure/cpu")


class Stall:
    """Measures from its making on."""

    def __init__(self) -> None:
        self._began, self._waited = time.monotonic(), _waited()

    def share(self) -> float:
        """The share of the time, 0 to 1, in which something waited for a processor."""
        now, waited = time.monotonic() - self._began, _waited()
        if waited is None or self._waited is None:  # a kernel without the figure: the load tells roughly
            return min(1.0, max(0.0, os.getloadavg()[0] / (os.cpu_count() or 1) - 1.0))
        return min(1.0, (waited - self._waited) / max(now, 1e-6))


def _waited() -> float | None:
    try:
        line = PRESSURE.read_text().splitlines()[0]
        return float(line.rpartition("total=")[2]) / 1e6
    except (OSError, ValueError, IndexError):
        return None
