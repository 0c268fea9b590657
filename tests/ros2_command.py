"""Runs `ros2` as a user's shell would, in a process of its own; see ros2_fork.py for how that starts."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from tempfile import NamedTemporaryFile

from tests import ros2_fork

COMMAND = (sys.executable, "-m", "course_kit.cli.ros2.command")
TIMEOUT = 60.0
FORKS = multiprocessing.get_context("forkserver")
FORKS.set_forkserver_preload(["tests.ros2_forks_from"])


# What is said of a look at the graph that takes long, which on a busy machine any may.
LATE = "Waiting for process ", "Waiting for a process of another user", "Waiting for topics and services of which nodes"


@dataclass(frozen=True)
class Outcome:
    """What a command line printed, and its exit status; `late` is what stderr says of those it waited for."""

    out: str
    err: str
    status: int
    seconds: float
    late: str = ""


def ros2(*words: str, interrupt_after: float | None = None, **environment: str) -> Outcome:
    """Run `ros2 words…` to its end; send SIGINT after some seconds if told so."""
    began = time.monotonic()
    with NamedTemporaryFile("r") as out, NamedTemporaryFile("r") as err:
        variables = os.environ | {"COLUMNS": "80"} | environment
        process = FORKS.Process(target=ros2_fork.run, args=(words, variables, out.name, err.name))
        process.start()
        assert process.pid is not None
        process.join(TIMEOUT if interrupt_after is None else interrupt_after)
        if process.is_alive():
            os.kill(process.pid, signal.SIGKILL if interrupt_after is None else signal.SIGINT)
        process.join(TIMEOUT)
        assert process.exitcode is not None, f"`ros2 {' '.join(words)}` does not end"
        said = err.read().splitlines(keepends=True)
        late = "".join(line for line in said if line.startswith(LATE))
        other = "".join(line for line in said if not line.startswith(LATE))
        return Outcome(out.read(), other, process.exitcode, time.monotonic() - began, late)


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
        end(process)


def end(process: subprocess.Popen[str]) -> None:
    """End a program in good order: when the lease of a killed node ends, others may stand still (CONTRIBUTING.md)."""
    process.send_signal(signal.SIGINT)
    try:
        process.wait(10)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
