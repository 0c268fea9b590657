"""Reads files that somebody else wrote: regular ones of bounded size only, for a FIFO or a device would block."""

from __future__ import annotations

import contextlib
import os
import stat
from collections.abc import Iterator
from pathlib import Path

MAX_SIZE = 1_000_000  # bytes of a file
MAX_ENTRIES = 5_000  # of a folder, with all below it
MAX_DEPTH = 12
OPEN = os.O_RDONLY | os.O_NONBLOCK | os.O_NOCTTY | os.O_CLOEXEC


def beginning_of(path: Path) -> bytes | None:
    """What a file holds, at most MAX_SIZE bytes and one; None if it is none that can be read, or not a regular one."""
    with contextlib.suppress(OSError, ValueError), open(os.open(path, OPEN), "rb") as file:
        if stat.S_ISREG(os.fstat(file.fileno()).st_mode):
            return file.read(MAX_SIZE + 1)
    return None


def data_of(path: Path) -> bytes | None:
    """The same; None also if it is longer than MAX_SIZE."""
    data = beginning_of(path)
    return None if data is None or len(data) > MAX_SIZE else data


def text_of(path: Path) -> str | None:
    """The same as text; what is no UTF-8 is replaced."""
    data = data_of(path)
    return None if data is None else data.decode("utf-8", "replace")


def are_same(path: Path, other: Path) -> bool:
    """Return True if two files say the same; of long ones the beginning is read."""
    with contextlib.suppress(OSError):
        data = beginning_of(path)
        return data is not None and path.stat().st_size == other.stat().st_size and data == beginning_of(other)
    return False


def entries(folder: Path) -> list[Path]:
    """What lies in a folder, sorted; nothing if there is none."""
    with contextlib.suppress(OSError), os.scandir(folder) as found:
        return sorted(Path(entry.path) for entry, _ in zip(found, range(MAX_ENTRIES), strict=False))
    return []


def below(folder: Path) -> Iterator[Path]:
    """The regular files below a folder, not those behind links to folders; without compiled Python."""
    seen = 0
    for root, folders, files in os.walk(folder):
        depth = len(Path(root).relative_to(folder).parts)
        folders[:] = sorted(f for f in folders if f != "__pycache__") if depth < MAX_DEPTH else []
        for name in sorted(files):
            seen += 1
            if seen > MAX_ENTRIES:
                return
            path = Path(root, name)
            if path.is_file():
                yield path
