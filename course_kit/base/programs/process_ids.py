"""The ids by which processes know themselves: other ones than here for those in a sandbox. Standard library only."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable
from pathlib import Path


def own_ids(pids: Iterable[int]) -> set[int]:
    """What these processes take for their ids, which is what DDS writes into the ids of their endpoints."""
    found = set()
    for pid in pids:
        with contextlib.suppress(OSError):  # it has ended
            lines = Path(f"/proc/{pid}/status").read_text(errors="replace").splitlines()
            in_namespaces = next((line for line in lines if line.startswith("NSpid:")), f"NSpid: {pid}")
            found.add(int(in_namespaces.split()[-1]))
    return found
