"""Runs `ros2` as a user's shell would: a process of its own."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

COMMAND = (sys.executable, "-m", "course_kit.ros2.command")
TIMEOUT = 60.0


@dataclass(frozen=True)
class Outcome:
    """What a command line printed, and its exit status."""

    out: str
    err: str
    status: int
    seconds: float


def ros2(*words: str, interrupt_after: float | None = None, **environment: str) -> Outcome:
    """Run `ros2 words…` to its end; send SIGINT after some seconds if told so."""
    began = time.monotonic()
    process = subprocess.Popen(
        [*COMMAND, *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"COLUMNS": "80"} | environment,
    )
    try:
        out, err = process.communicate(timeout=TIMEOUT if interrupt_after is None else interrupt_after)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGINT if interrupt_after is not None else signal.SIGKILL)
        out, err = process.communicate(timeout=TIMEOUT)
    return Outcome(out, err, process.returncode, time.monotonic() - began)


@contextmanager
def program(module: str, *arguments: str, ready: str = "ready") -> Iterator[subprocess.Popen[str]]:
    """Run a Python module that prints a line once it is ready, until the block ends."""
    process = subprocess.Popen(
        [sys.executable, "-m", module, *arguments], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    )
    try:
        assert process.stdout is not None
        for line in process.stdout:
            if line.strip() == ready:
                break
        yield process
    finally:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
