"""A port in shared memory whose mutex a dead process holds is given back, so that nobody waits for it.

Fast DDS waits a second for such a mutex, with each message. The port is made here, as far as the watchdog looks at it.
"""

from __future__ import annotations

import ctypes
import mmap
import os
import struct
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from course_kit.base.shutdown.shared_memory import FOLDER
from tests.programs.dead_segments import PORT_SIZE
from tests.programs.endless_recovery import FLAGS, IS_IN_ORDER, LIBRARY, MUTEX, NUMBER, Port
from tests.waiting import wait_until

READY = b"\2"  # the state of a segment, in its first byte
ATTRIBUTES, SHARED = 64, 1  # the size of a mutex's attributes, in bytes, and PTHREAD_PROCESS_SHARED
LOOKS = 1.2  # seconds in which the watchdog looks four times at files, and once at removed ones
GIVEN_BACK = 20.0  # seconds; a quiet machine needs a quarter of one, and one for a removed port
# Has a port and waits for its mutex; says when it begins to, and whether the port is in order when it has it.
WAITS = """
import sys
from pathlib import Path
from course_kit.base.shutdown import watchdog
from tests.programs.endless_recovery import Port
port = Port(Path(sys.argv[1]))
print("begins", flush=True)
sys.stdin.readline()
watchdog.begin()
port.lock()
print(port.is_in_order, flush=True)
"""
# Has a port's mutex until it is killed. Its number is that of a process of another namespace if one is given.
HOLDS = """
import os, sys, time
from pathlib import Path
from tests.programs.endless_recovery import Port
port = Port(Path(sys.argv[1]))
for last in sys.argv[2:]:
    Path("/proc/sys/kernel/ns_last_pid").write_text(last)
    if os.fork():
        os.wait()
port.lock()
print(os.getpid(), flush=True)
time.sleep(100)
"""


@pytest.fixture
def path() -> Iterator[Path]:
    """A port in order, of a number that no domain has."""
    number = os.getpid() + 80_000
    path = FOLDER / f"fastrtps_port{number}"
    path.write_bytes(READY + bytes(PORT_SIZE - 1))
    with open(path, "r+b") as file, mmap.mmap(file.fileno(), 0) as memory:
        struct.pack_into("I", memory, NUMBER, number)
        memory[FLAGS] = IS_IN_ORDER
        attributes, mutex = ctypes.create_string_buffer(ATTRIBUTES), ctypes.create_string_buffer(40)
        LIBRARY.pthread_mutexattr_init(attributes)
        LIBRARY.pthread_mutexattr_setpshared(attributes, SHARED)
        LIBRARY.pthread_mutex_init(mutex, attributes)
        memory[MUTEX : MUTEX + len(mutex)] = mutex.raw
    yield path
    path.unlink(missing_ok=True)


def begin(code: str, *arguments: object, before: tuple[str, ...] = ()) -> subprocess.Popen[str]:
    command = [*before, sys.executable, "-c", code, *map(str, arguments)]
    return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)


def said_by(process: subprocess.Popen[str]) -> str:
    assert process.stdout is not None
    return process.stdout.readline().strip()


def go_on(process: subprocess.Popen[str]) -> None:
    assert process.stdin is not None
    process.stdin.write("\n")
    process.stdin.flush()


@pytest.mark.parametrize("is_removed", [False, True], ids=["a file", "removed"])
def test_who_waits_for_the_dead_goes_on(path: Path, is_removed: bool) -> None:
    with begin(HOLDS, path) as holding, begin(WAITS, path) as waiting:
        try:
            assert said_by(holding)
            assert said_by(waiting) == "begins"
            port = Port(path)
            if is_removed:
                path.unlink()
            go_on(waiting)
            wait_until(lambda: port.is_awaited)
            time.sleep(LOOKS)
            assert port.is_awaited  # the living keep it
            assert port.is_in_order
            holding.kill()
            # The dead may have been in the midst of a change, so the port is out of order.
            assert waiting.communicate(timeout=GIVEN_BACK)[0].split() == ["False"]
        finally:
            holding.kill()
            waiting.kill()


@pytest.mark.skipif(os.getuid() != 0, reason="only root can make a namespace with processes of chosen numbers")
def test_who_lives_in_a_sandbox_keeps_it(path: Path) -> None:
    """There it has another number, which nobody may have outside."""
    free = next(number for number in range(30_000, 2, -1) if not Path(f"/proc/{number}").exists())
    sandbox = ("unshare", "--mount", "--pid", "--fork", "--kill-child", "--mount-proc")
    with begin(HOLDS, path, free - 1, before=sandbox) as holding, begin(WAITS, path) as waiting:
        try:
            assert said_by(holding) == str(free)
            assert said_by(waiting) == "begins"
            port = Port(path)
            go_on(waiting)
            wait_until(lambda: port.is_awaited)
            time.sleep(LOOKS)
            assert port.is_awaited
            assert port.is_in_order
        finally:
            holding.kill()
            waiting.kill()
