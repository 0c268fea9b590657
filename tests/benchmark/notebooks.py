"""How long each notebook takes under nbval, and how much memory its kernel uses at most."""

from __future__ import annotations

import contextlib
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import psutil  # type: ignore[import-untyped]

from tests.benchmark.child import ROOT, environment
from tests.benchmark.table import Row
from tests.domains import reserve_domain

TIMEOUT = 600.0
NOTE = "notebooks: pytest --nbval on each notebook, with the start of pytest and kernel; memory resident of the kernel."


def rows(quick: bool) -> Iterator[Row]:
    """All rows of this section."""
    for path in sorted((ROOT / "notebooks").glob("*.ipynb")):
        runs = [_run(path, reserve_domain()) for _ in range(1 if quick else 3)]
        yield Row(f"{path.stem}: time", "s", None, statistics.median(seconds for seconds, _ in runs))
        yield Row(f"{path.stem}: peak memory", "MB", None, statistics.median(memory for _, memory in runs))


def _run(path: Path, domain: int) -> tuple[float, float]:
    """Seconds of the whole run, and the most megabytes that its kernel had."""
    command = [sys.executable, "-m", "pytest", "--nbval", "-p", "no:cacheprovider", "-q", path.name]
    began = time.monotonic()
    process = subprocess.Popen(
        command, cwd=path.parent, env=environment(domain), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    most = 0
    while process.poll() is None:
        most = max(most, _kernel_memory(process.pid))
        if time.monotonic() > began + TIMEOUT:
            process.kill()
            raise RuntimeError(f"{path.name} did not end within {TIMEOUT:g} s")
        time.sleep(0.05)
    if process.returncode:
        raise RuntimeError(f"{path.name} fails: run {' '.join(command[1:])}")
    return time.monotonic() - began, most / 1e6


def _kernel_memory(pid: int) -> int:
    """Resident bytes of the kernel that pytest has started, or 0."""
    memory = 0
    with contextlib.suppress(psutil.Error):
        for child in psutil.Process(pid).children(recursive=True):
            with contextlib.suppress(psutil.Error):
                if "ipykernel_launcher" in " ".join(child.cmdline()):
                    memory = max(memory, child.memory_info().rss)
    return memory
