"""No process of a launch outlives it: each is marked in its environment, and a watcher ends those that are left.

Run as a program it is the watcher: it waits for the launch to end and, unless that says that all is well, as when it
was killed, ends every process that carries the mark, grandchildren included. Linux only, for it reads /proc.
Standard library only: it is started without the environment's packages, so that it costs little.
"""

from __future__ import annotations

import contextlib
import itertools
import os
import signal
import subprocess
import sys
import time
import uuid
from collections.abc import Mapping
from pathlib import Path

VARIABLE = "COURSE_KIT_LAUNCH"
STEPS = ((signal.SIGINT, 2.0), (signal.SIGTERM, 2.0), (signal.SIGKILL, 1.0))  # signal, seconds to end after it
POLL = 0.02
ALL_IS_WELL = b"."


def with_mark(environment: Mapping[str, str], token: str) -> dict[str, str]:
    """The environment of a process, marked; a launch in a launch adds its mark to that of the outer one."""
    return {**environment, VARIABLE: f"{environment.get(VARIABLE, '')} {token}".lstrip()}


def marked(token: str) -> list[int]:
    """The processes that carry the mark and are neither this one nor dead."""
    found = []
    start, needle = f"{VARIABLE}=".encode(), token.encode()
    for entry in os.listdir("/proc") if os.path.isdir("/proc") else ():
        if not entry.isdigit() or int(entry) == os.getpid():
            continue
        try:
            variables = Path("/proc", entry, "environ").read_bytes().split(b"\0")
        except OSError:  # it ended meanwhile, or is another user's
            continue
        if any(v.startswith(start) and needle in v for v in variables):
            found.append(int(entry))
    return found


def end_all(token: str) -> None:
    """End all marked processes: ask first, then less and less kindly."""
    for number, patience in STEPS:
        left = marked(token)
        for pid in left:
            with contextlib.suppress(OSError):
                os.kill(pid, number)
        deadline = time.monotonic() + patience
        while left and time.monotonic() < deadline:
            time.sleep(POLL)
            left = marked(token)
        if not left:
            return


class Watch:
    """The watcher of one launch, seen from the launch."""

    def __init__(self, apart: bool = False) -> None:
        """`apart`: in a session of its own, so that signals for this process group do not reach it."""
        self.token = f"{os.getpid()}-{uuid.uuid4().hex}"
        self._count = itertools.count(1)
        # The watcher blocks SIGINT, so that one that the whole process group got stays visible as pending.
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            self._process: subprocess.Popen[bytes] | None = subprocess.Popen(
                [sys.executable, "-I", "-S", __file__, self.token],
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                start_new_session=apart,
            )
        except OSError:  # without it the launch runs all the same
            self._process = None
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)

    def new_mark(self) -> str:
        """A mark for one process and what it starts."""
        return f"{self.token}-{next(self._count)}."  # the dot: no mark is the beginning of another

    def whole_group_was_interrupted(self) -> bool:
        """Return True if a SIGINT came to all processes of the group, as Ctrl-C in a terminal sends it."""
        if self._process is None:
            return True
        try:
            lines = Path("/proc", str(self._process.pid), "status").read_text().splitlines()
        except OSError:
            return True
        pending = next((int(line.split()[1], 16) for line in lines if line.startswith("ShdPnd:")), 0)
        return bool(pending >> (signal.SIGINT - 1) & 1)

    def close(self) -> None:
        """End what is left of the launch, then the watcher."""
        end_all(self.token)
        self.dismiss()

    def dismiss(self) -> None:
        """End the watcher."""
        if self._process is None or self._process.stdin is None:
            return
        with contextlib.suppress(OSError):
            self._process.stdin.write(ALL_IS_WELL)
            self._process.stdin.close()
        self._process.wait()


def main() -> None:
    """Be the watcher."""
    for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
        signal.signal(number, signal.SIG_IGN)
    if os.read(0, 1) != ALL_IS_WELL:
        end_all(sys.argv[1])


if __name__ == "__main__":
    main()
