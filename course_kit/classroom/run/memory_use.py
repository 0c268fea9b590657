"""The memory of processes, and of files without a disk. Needs no ROS."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterable
from pathlib import Path

import psutil  # type: ignore[import-untyped]

BLOCK = 512  # bytes of st_blocks
MEMFD = "/memfd:"  # what the link of a file begins with that lies in memory only


def of(processes: Iterable[psutil.Process]) -> int:
    """The bytes that these processes use."""
    used = 0
    for process in processes:
        with contextlib.suppress(psutil.Error):  # it has ended
            used += process.memory_info().rss
    return used


def of_files(processes: Iterable[psutil.Process]) -> int:
    """The bytes of the files in memory that these processes have open, whether they map them or not."""
    files: dict[tuple[int, int], int] = {}
    for process in processes:
        with contextlib.suppress(OSError):  # it has ended
            for entry in os.scandir(f"/proc/{process.pid}/fd"):
                with contextlib.suppress(OSError):
                    if os.readlink(entry.path).startswith(MEMFD):
                        file = os.stat(entry.path)
                        files[file.st_dev, file.st_ino] = file.st_blocks * BLOCK
    return sum(files.values())


def in_files() -> int:
    """The bytes of memory on this machine that are shared, or in files that lie in it; 0 where it is not told."""
    with contextlib.suppress(OSError, StopIteration, ValueError):
        lines = Path("/proc/meminfo").read_text().splitlines()
        return 1024 * int(next(line for line in lines if line.startswith("Shmem:")).split()[1])
    return 0
