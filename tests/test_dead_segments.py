"""What dead processes left in shared memory stops nobody: it is healed, also while somebody waits on it.

The programs are dead_segments.py, endless_recovery.py and storm.py in tests/programs;
`python -m tests.benchmark dead_segments` has more.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from functools import partial
from pathlib import Path

import pytest

from course_kit.base import polling
from course_kit.base.shutdown import watchdog
from course_kit.base.shutdown.shared_memory import FOLDER
from tests.benchmark.dead_segments import outcome
from tests.programs.dead_segments import CASES, DEAD, in_own_shared_memory
from tests.waiting import wait_until

HEALED = 20.0  # seconds; a quiet machine needs less than 2, as the benchmark shows
OLD = 5.0  # seconds: older than what may still be made
READY = b"\2" + bytes(4095)
STANDS_STILL = """
import os, signal, sys
file = open(sys.argv[1])
print("here", flush=True)
os.kill(os.getpid(), signal.SIGSTOP)
"""
# Opens what it can, but for the two folders that it looks into, and heals when it is told to.
LACKS_DESCRIPTORS = """
import os, resource
from course_kit.base.shutdown import watchdog
watchdog.heal()
resource.setrlimit(resource.RLIMIT_NOFILE, (64, 64))
opened = []
try:
    while True:
        opened.append(os.open(os.devnull, os.O_RDONLY))
except OSError:
    os.close(opened.pop())
    os.close(opened.pop())
while True:
    input()
    print(watchdog.heal(), flush=True)
"""
HEALS_ON_AND_ON = """
from course_kit.base.shutdown import watchdog
print("begun", flush=True)
while True:
    watchdog.heal()
"""
HIDDEN_MAKER = """
import os, time
from pathlib import Path
from course_kit.base.shutdown import watchdog
path = Path("/dev/shm/fastrtps_port70000")
def stays(age):
    path.write_bytes(bytes(4096))
    made = time.time() - age
    os.utime(path, (made, made))
    watchdog.heal()
    return path.exists() or (age < 1.0 < time.time() - made and stays(age))  # again, if this took too long
print(stays(0.2), stays(1.2))
"""
ROUNDS = 100
as_root = pytest.mark.skipif(os.getuid() != 0, reason="only root can mount a shared memory of its own")


@as_root
@pytest.mark.by_turns("programs for each", of="cases")
@pytest.mark.parametrize("case", CASES)
def test_it_holds_no_program_for_long(case: str) -> None:
    assert max(outcome("tests.programs.dead_segments", case, "2")) < HEALED


@as_root
@pytest.mark.by_turns("programs for each", of="cases")
@pytest.mark.parametrize("guard", ["itself", "another"])
def test_a_writer_whose_reader_died_in_the_midst_of_a_message_goes_on(guard: str) -> None:
    assert max(outcome("tests.programs.endless_recovery", guard, "2")) < HEALED


@as_root
@pytest.mark.cpu_bound
@pytest.mark.xdist_group("storm")
def test_a_storm_of_killed_processes_makes_nobody_hang_and_nobody_deaf() -> None:
    """How long a new node takes on a quiet machine is measured by the benchmark."""
    ended = outcome("tests.programs.storm", "200")
    assert ended["killed"] == 200
    assert max(ended["new_node"]) < HEALED
    assert (ended["deaf"], ended["hanging"]) == ([], 0)


@pytest.fixture
def segment() -> Iterator[Path]:
    """A file with a name as Fast DDS gives it, of a port that no domain has. Other processes heal too, by chance."""
    path = FOLDER / f"fastrtps_port{os.getpid() + 70_000}"
    yield path
    path.unlink(missing_ok=True)


def age(path: Path, seconds: float) -> None:
    os.utime(path, (time.time() - seconds,) * 2)


@pytest.mark.parametrize("kind", DEAD)
def test_one_that_nobody_has_goes_at_once(kind: str, segment: Path) -> None:
    segment.write_bytes(DEAD[kind])
    age(segment, 0.5)
    watchdog.heal()
    assert not segment.exists()


@pytest.mark.parametrize("kind", DEAD)
def test_who_waits_on_one_sees_that_it_is_corrupted(kind: str, segment: Path) -> None:
    segment.write_bytes(DEAD[kind])
    with open(segment, "rb") as waiting:
        age(segment, OLD)
        watchdog.heal()
        assert not segment.exists()
        wait_until(lambda: os.pread(waiting.fileno(), 4, 0) == b"\3\0\0\0")  # it may be another process that heals


def test_one_that_is_being_made_is_left(segment: Path) -> None:
    """By a process that has it, and has begun a moment ago; or by one that cannot be seen, in a container."""
    for has_it, seconds, limit in [(True, 0.3, 0.9), (False, 0.0, 0.1)]:
        wait_until(partial(is_left, segment, has_it, seconds, limit, watchdog.heal))


@as_root
def test_one_whose_maker_may_be_hidden_is_left_for_a_second() -> None:
    """In the sandbox of an answer, whose checker is out of sight."""
    command = in_own_shared_memory(sys.executable, "-c", HIDDEN_MAKER)
    environ = {**os.environ, watchdog.HIDDEN: "1"}
    done = subprocess.run(command, env=environ, capture_output=True, text=True, timeout=60)
    assert done.stdout.split() == ["True", "False"], done.stderr


def test_who_lacks_the_means_to_see_who_has_it_leaves_it(segment: Path) -> None:
    command = [sys.executable, "-c", LACKS_DESCRIPTORS]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0) as healing:

        def heal() -> None:
            assert healing.stdin is not None and healing.stdout is not None
            healing.stdin.write(b"\n")
            assert healing.stdout.readline()

        heal()
        wait_until(lambda: is_left(segment, True, 0.3, 0.9, heal))
        healing.kill()


def test_one_that_is_made_where_a_dead_one_was_a_moment_ago_is_left(segment: Path) -> None:
    """Others may still look for those who have the dead one."""
    command = [sys.executable, "-c", HEALS_ON_AND_ON]
    with ExitStack() as stack:
        for _ in range(4):
            healing = stack.enter_context(subprocess.Popen(command, stdout=subprocess.PIPE))
            stack.callback(healing.kill)
            assert healing.stdout is not None and healing.stdout.readline()
        for _ in range(ROUNDS):
            segment.write_bytes(DEAD["zero"])
            age(segment, OLD)
            assert polling.wait_until(lambda: not segment.exists(), 20.0, poll=0.0)
            with open(segment, "wb") as file:
                file.write(DEAD["zero"])
                file.flush()
                made = time.time()
                time.sleep(0.01)  # they finish what they have begun
                assert segment.exists() or time.time() - made > 1.0
            segment.unlink(missing_ok=True)


def is_left(segment: Path, has_it: bool, seconds: float, limit: float, heal: Callable[[], object]) -> bool | None:
    """Heal, and see that a half-made file of this age stays. None if it got older than the limit meanwhile."""
    segment.unlink(missing_ok=True)  # another process may be healing that of the try before, which nobody has
    with open(segment, "wb") as file:
        file.write(DEAD["zero"])
        file.flush()
        if not has_it:
            file.close()
        age(segment, seconds)
        made = time.time() - seconds
        heal()
        stays = segment.exists()
    if time.time() - made > limit:
        return None
    assert stays
    return True


def test_one_whose_maker_may_stand_still_is_left(segment: Path) -> None:
    segment.write_bytes(DEAD["zero"])
    age(segment, -OLD)  # so that nobody takes it before the maker has it
    with subprocess.Popen([sys.executable, "-c", STANDS_STILL, str(segment)], stdout=subprocess.PIPE) as maker:
        assert maker.stdout is not None and maker.stdout.readline()
        os.waitid(os.P_PID, maker.pid, os.WSTOPPED)
        age(segment, OLD)
        watchdog.heal()
        is_left = segment.exists()
        maker.kill()
    assert is_left


def test_ready_ones_and_what_is_no_segment_are_left(segment: Path) -> None:
    others = [segment.with_name(f"other_{segment.name}"), segment.with_name(f"{segment.name}_el")]
    segment.write_bytes(READY)
    for other in others:
        other.touch()
        age(other, OLD)
    age(segment, OLD)
    try:
        watchdog.heal()
        assert all(path.exists() for path in (segment, *others))
    finally:
        for other in others:
            other.unlink()


def test_one_that_has_the_number_of_a_ready_one_goes(segment: Path) -> None:
    """Ready ones are remembered by their numbers, for a while."""

    def is_healed() -> bool:
        watchdog.heal()
        return not segment.exists()

    segment.write_bytes(READY)
    age(segment, OLD)
    watchdog.heal()
    with open(segment, "r+b") as same_file:
        same_file.write(DEAD["initializing"])
    age(segment, OLD)
    wait_until(is_healed)


@as_root
def test_one_of_another_user_is_left(segment: Path) -> None:
    segment.write_bytes(DEAD["zero"])
    os.chown(segment, 65534, 65534)
    age(segment, OLD)
    watchdog.heal()
    assert segment.exists()
    assert segment.read_bytes()[:4] == bytes(4)
