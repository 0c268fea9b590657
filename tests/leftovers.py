"""What tests could leave on the machine: temporary files, Fast DDS's shared memory, processes.

All of a run's processes have one folder for temporary files, and a mark in their environment by which to find them.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import subprocess
import tempfile

import psutil  # type: ignore[import-untyped]

MARK = "COURSE_KIT_TEST_RUN"


def begin() -> None:
    """Give this process and its children the folder and the mark."""
    folder = tempfile.mkdtemp(prefix="ck-")
    os.environ["TMPDIR"] = os.environ[MARK] = folder
    tempfile.tempdir = None  # it is looked up once


def remove_files() -> None:
    """Remove the folder with all that is in it."""
    shutil.rmtree(os.environ[MARK], ignore_errors=True)


def remove_shared_memory() -> None:
    """Remove what killed processes had in shared memory; Fast DDS's own command leaves alone what is in use."""
    subprocess.run(["fastdds", "shm", "clean"], stdout=subprocess.DEVNULL, check=True, timeout=60)


def processes() -> list[str]:
    """The command lines of the run's processes that are still there, without this one and those that it is part of."""
    own = {os.getpid(), *(parent.pid for parent in psutil.Process().parents())}
    found = []
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.Error):
            if process.pid not in own and process.environ().get(MARK) == os.environ[MARK]:
                found.append(f"{process.pid} {' '.join(process.cmdline())}")
    return found
