"""What tests could leave on the machine: temporary files, Fast DDS's shared memory, processes.

All of a run's processes have one folder for temporary files, and a mark in their environment by which to find them.
"""

from __future__ import annotations

import atexit
import contextlib
import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import psutil  # type: ignore[import-untyped]

from course_kit.base.polling import wait_until
from course_kit.base.shutdown import shared_memory
from tests import domains

MARK = "COURSE_KIT_TEST_RUN"
FIRST_PORT, PORTS = 7400, 250  # of domain 0, and of each domain
PORT, SEGMENT = re.compile(r"fastrtps_port\d+"), re.compile(r"fastrtps_[0-9a-f]{16}")
SERVANTS = ("multiprocessing", "programs/orphans.py")  # end with the process that they serve
CCACHE = Path("/usr/lib/ccache")
KEPT = Path(__file__).parents[1] / "build/failed-tests"


def begin() -> None:
    """Give this process and its children the folder and the mark; the folder goes when this process ends."""
    folder = tempfile.mkdtemp(prefix="ck-")
    os.environ["TMPDIR"] = os.environ[MARK] = folder
    tempfile.tempdir = None  # it is looked up once
    atexit.register(shutil.rmtree, folder, ignore_errors=True)


def compile_once() -> None:
    """Have what was compiled once in this run not compiled again, where Debian's ccache is installed."""
    if CCACHE.is_dir():
        folder = os.environ[MARK]
        os.environ["PATH"] = os.pathsep.join([str(CCACHE), os.environ["PATH"]])
        os.environ |= {"CCACHE_DIR": f"{folder}/ccache", "CCACHE_BASEDIR": folder, "CCACHE_NOHASHDIR": "1"}


def keep_files() -> None:
    """Put the folder's files where they are kept until the next run that fails."""
    shutil.rmtree(KEPT, ignore_errors=True)
    KEPT.parent.mkdir(exist_ok=True)
    subprocess.run(["cp", "-a", os.environ[MARK], KEPT], timeout=60)  # sockets too, which shutil cannot


def remove_shared_memory() -> None:
    """Remove what killed processes had in shared memory: segments, and ports.

    While another process uses Fast DDS, of the ports only those in domains that no test process has.
    """

    def are_gone() -> bool:
        shared_memory.tidy()
        return not _unused(SEGMENT)

    wait_until(are_gone, shared_memory.NEW + 1.0, poll=0.5)
    is_quiet = not any(map(_uses_shared_memory, psutil.pids()))
    for port in _unused(PORT):
        domain = (int(port.name.removeprefix("fastrtps_port")) - FIRST_PORT) // PORTS
        if is_quiet or (domain in domains.OF_TESTS and domains.take(domain)):
            for name in (port.name, f"{port.name}_el", f"sem.{port.name}_mutex"):
                port.with_name(name).unlink(missing_ok=True)


def made_by(pid: int) -> list[Path]:
    """The segments that a process has made, and their locks; none of one that has ended."""
    found = set()
    with contextlib.suppress(FileNotFoundError):
        for entry in Path(f"/proc/{pid}/fd").iterdir():
            lock = Path(os.path.realpath(entry))
            if lock.parent == shared_memory.FOLDER and shared_memory.LOCK.fullmatch(lock.name):
                found |= {lock.with_name(lock.name.removesuffix("_el")), lock}
    return sorted(found)


def _uses_shared_memory(process: int) -> bool:
    with contextlib.suppress(OSError):  # it has ended, or is another user's
        return bytes(shared_memory.FOLDER / "fastrtps_") in Path(f"/proc/{process}/maps").read_bytes()
    return False


def _unused(kind: re.Pattern[str]) -> list[Path]:
    """This user's files of a kind in Fast DDS's shared memory, of which no process holds the lock."""
    held = {line.split()[5].rpartition(":")[2] for line in Path("/proc/locks").read_text().splitlines()}
    found = []
    for path in shared_memory.FOLDER.iterdir():
        lock = path.with_name(f"{path.name}_el")
        with contextlib.suppress(FileNotFoundError):
            if kind.fullmatch(path.name) and path.stat().st_uid == os.getuid():
                found += [] if lock.exists() and str(lock.stat().st_ino) in held else [path]
    return found


def end_processes() -> list[str]:
    """Kill the run's processes that do not end by themselves; return what they are."""
    wait_until(lambda: not _processes(), timeout=5.0)
    killed = []
    for process in _processes():
        with contextlib.suppress(psutil.Error):
            killed.append(f"{process.pid} {' '.join(process.cmdline())}")
            process.kill()
    return killed


def kill_what_is_left_of(worker: str) -> None:
    """Kill the processes of tests whose worker, such as "gw3", has ended in the midst: its domains are free again."""
    for process in _processes(PYTEST_XDIST_WORKER=worker):
        with contextlib.suppress(psutil.Error):
            process.kill()


def _processes(**marks: str) -> list[psutil.Process]:
    """The run's processes with these variables in their environment, but for this one and those that it is part of."""
    own = {os.getpid(), *(parent.pid for parent in psutil.Process().parents())}
    marks[MARK] = os.environ[MARK]
    found = []
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.Error):
            if process.pid in own or not marks.items() <= process.environ().items():
                continue
            if not any(servant in " ".join(process.cmdline()) for servant in SERVANTS):
                found.append(process)
    return found
