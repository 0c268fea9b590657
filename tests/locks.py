"""Locks between test processes: a socket with a name, which has no file and goes with its process."""

from __future__ import annotations

import contextlib
import socket


def lock(name: str) -> socket.socket | None:
    """Have a name until the socket is closed, or this process ends; None if another socket of this machine has it."""
    held = socket.socket(socket.AF_UNIX)
    with contextlib.suppress(OSError):
        held.bind(f"\0{name}")
        return held
    held.close()
    return None
