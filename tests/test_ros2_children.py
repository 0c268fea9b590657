"""`%ros2 launch` and `%ros2 run` in a real kernel: lines stream into the cell, and the kernel leaves nothing behind."""

from __future__ import annotations

import os
import re
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.kernel import Kernel
from tests.ros2_launches import Prefix, RunningGroup, none_left
from tests.waiting import wait_until

TICKING = "import os, time\nprint('pid', os.getpid(), flush=True)\nwhile True: time.sleep(0.1)"
POLITE = """
import os, sys, time
try:
    print('pid', os.getpid(), flush=True)
    while True: time.sleep(0.1)
except KeyboardInterrupt:
    print('polite', file=sys.stderr)
"""

QUIET = """
import os, sys, time
try:
    print('pid', os.getpid(), flush=True)
    while len(sys.argv) == 1: time.sleep(0.1)
except KeyboardInterrupt:
    pass
os.close(1), os.close(2)
time.sleep(0.5)
open(os.environ['ENDED'], 'x').close()
os._exit(3)
"""


@pytest.fixture
def prefix(tmp_path: Path) -> Prefix:
    prefix = Prefix(tmp_path / "install")
    prefix.launch_file("demo", "demo.launch.py", f"python({POLITE!r}), python({TICKING!r})")
    prefix.program("demo", "polite", POLITE)
    prefix.program("demo", "quiet", QUIET)
    return prefix


@pytest.fixture
def kernel(prefix: Prefix) -> Iterator[Kernel]:
    kernel = Kernel()
    try:
        kernel.run(f"import os; os.environ.update({prefix.environment!r})")
        yield kernel
    finally:
        kernel.close()


def pids(kernel: Kernel, cell: str, count: int) -> list[int]:
    kernel.until(lambda: len(re.findall(r"pid \d+\n", kernel.text(cell))) >= count, 30)
    return [int(pid) for pid in re.findall(r"pid (\d+)\n", kernel.text(cell))]


def test_a_launch_streams_and_ends_with_the_interrupt_button(kernel: Kernel) -> None:
    cell = kernel.send("%ros2 launch demo demo.launch.py")
    processes = pids(kernel, cell, 2)
    kernel.manager.interrupt_kernel()
    kernel.finish(cell)
    text = kernel.text(cell)
    assert "[INFO] [child-1]: process has finished cleanly" in text
    assert "[child-1] polite" in text
    assert re.search(r"\[ERROR\] \[child-2\]: process has died \[pid \d+, exit code -2, cmd", text)
    assert text.count("user interrupted with ctrl-c") == 1
    assert none_left(processes)
    assert kernel.text(kernel.run("print('alive')")) == "alive\n"


def test_a_program_streams_and_ends_after_its_duration(kernel: Kernel) -> None:
    cell = kernel.run("%ros2 run --duration 1 demo polite")
    (process,) = pids(kernel, cell, 1)
    assert kernel.text(cell) == f"pid {process}\npolite\n"
    assert none_left([process])


@pytest.mark.parametrize("how, status", [("--duration 1 demo quiet", None), ("demo quiet now", 3)])
def test_a_program_that_closes_its_output_is_awaited_not_killed(
    kernel: Kernel, tmp_path: Path, how: str, status: int | None
) -> None:
    ended = tmp_path / "ended"
    kernel.run(f"os.environ['ENDED'] = {str(ended)!r}")
    cell = kernel.run(f"%ros2 run {how}")
    assert ended.exists()
    (process,) = pids(kernel, cell, 1)
    assert none_left([process])
    said = "" if status is None else f"[ros2run]: Process exited with failure {status}\n"
    assert kernel.text(cell) == f"pid {process}\n{said}"


def test_nothing_is_left_when_the_kernel_is_killed(kernel: Kernel) -> None:
    kernel_pid = int(kernel.text(kernel.run("print(os.getpid())")))
    cell = kernel.send("%ros2 launch demo demo.launch.py")
    processes = pids(kernel, cell, 2)
    os.kill(kernel_pid, signal.SIGKILL)
    wait_until(lambda: none_left(processes), f"end of {processes}", timeout=20)


def test_a_duration_ends_a_launch_in_a_terminal_too(prefix: Prefix) -> None:
    with RunningGroup("launch", "--duration", "5", "demo", "demo.launch.py", environment=prefix.environment) as running:
        started = running.pids(2)
        assert running.end().status == 0
        assert "[child-1] polite" in running.lines
        assert none_left(started)
