"""Starts the measured programs in processes of their own and reads what they report."""

from __future__ import annotations

import json
import os
import queue
import subprocess
import sys
import tempfile
import threading
from pathlib import Path
from typing import Any

from tests.benchmark import programs

ROOT = Path(__file__).resolve().parents[2]
PROFILES = {
    "stock": Path(__file__).with_name("stock_profile.xml"),
    "course": ROOT / "course_kit/setup/environment/fastdds_profile.xml",
}
START_TIMEOUT = 60.0


def environment(domain: int, profile: str = "course") -> dict[str, str]:
    """The variables of a measured process: its ROS domain on this machine, its Fast DDS profile.

    Compiled modules are cached as on a user's machine, in a folder apart.
    """
    kept = {k: v for k, v in os.environ.items() if k not in ("PYTHONDONTWRITEBYTECODE", "ROS_LOCALHOST_ONLY")}
    return kept | {
        "FASTRTPS_DEFAULT_PROFILES_FILE": str(PROFILES[profile]),
        "PYTHONPYCACHEPREFIX": str(Path(tempfile.gettempdir(), f"course-kit-benchmark-{os.getuid()}")),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "ROS_DOMAIN_ID": str(domain),
    }


class Program:
    """A module in a process of its own: one of tests/benchmark/programs, or by its full name any other.

    The first end when their input is closed, any other is told to with SIGTERM.
    """

    def __init__(self, module: str, *arguments: object, domain: int, profile: str = "course") -> None:
        self._is_ours = "." not in module
        name = f"{programs.__name__}.{module}" if self._is_ours else module
        self._process = subprocess.Popen(
            [sys.executable, "-m", name, *map(str, arguments)],
            cwd=ROOT,
            env=environment(domain, profile),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.pid = self._process.pid
        self._name = " ".join([module, *map(str, arguments)])
        self._lines: queue.Queue[str | None] = queue.Queue()
        threading.Thread(target=self._collect, daemon=True).start()

    def _collect(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self._lines.put(line)
        self._lines.put(None)

    def report(self, timeout: float = START_TIMEOUT) -> Any:
        """The next JSON object that the program prints; RuntimeError if none comes within `timeout` seconds."""
        try:
            line = self._lines.get(timeout=timeout)
        except queue.Empty:
            raise RuntimeError(f"{self._name} reported nothing for {timeout:g} s") from None
        if line is None:
            raise RuntimeError(f"{self._name} ended without a report")
        try:
            return json.loads(line)
        except ValueError:
            raise RuntimeError(f"{self._name} printed what is no report: {line.rstrip()}") from None

    def tell(self, command: str) -> None:
        """Send the program one line."""
        assert self._process.stdin is not None
        self._process.stdin.write(command + "\n")
        self._process.stdin.flush()

    def end(self) -> None:
        """Let the program end in good order: a node that is killed stays in the graph for seconds."""
        assert self._process.stdin is not None
        try:
            self._process.stdin.close()
            if not self._is_ours:
                self._process.terminate()
            self._process.wait(timeout=10)
        except (subprocess.TimeoutExpired, BrokenPipeError):
            self._process.kill()
            self._process.wait()

    def __enter__(self) -> Program:
        return self

    def __exit__(self, *_: object) -> None:
        self.end()
