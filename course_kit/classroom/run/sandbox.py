"""Two sandboxes of Debian's bubblewrap: the outer one holds the checker and nbval, the inner ones a student's code.

The outer one has a network (loopback only), a /dev/shm, an IPC and processes of its own. An inner one sees its own
processes only, one folder that it may write, and of the machine what Python and ROS need. They meet over ROS.
"""

from __future__ import annotations

import functools
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from course_kit.base.shutdown.watchdog import HIDDEN
from course_kit.exercises.solutions import worked
from course_kit.setup.environment.activation import sourced_ros

APART = "bubblewrap: own network, processes, files and shared memory; limits of time, memory, disk and processes"
NOT_APART = (
    "none: without bubblewrap the students' code runs with the rights of who grades, in process groups with limits of "
    "time, memory and file size"
)
MB = 1 << 20
TRY_TIMEOUT = 20.0
# Of /proc what changes the machine: root may write it, whatever rights it has dropped.
_SETTINGS = tuple(
    word for name in ("sys", "sysrq-trigger", "irq", "bus") for word in ("--ro-bind-try", *2 * (f"/proc/{name}",))
)
# Of /etc only what names users and finds libraries, fonts and the time.
ETC = ("alternatives", "fonts", "ld.so.cache", "ld.so.conf", "ld.so.conf.d", "localtime", "timezone")


@dataclass(frozen=True)
class Limits:
    """What a student's code may use."""

    memory: int = 3_000 * MB  # of all her processes together; bytes
    disk: int = 512 * MB  # of the folder that she may write, and of one file
    processes: int = 200
    processor: int = 900  # seconds of one process


@dataclass(frozen=True)
class Places:
    """The folders of one job, as the processes in the outer sandbox see them."""

    job: Path  # the rebuilt notebook, what is to be done, what was found
    work: Path  # what the student's code may write; the kernel runs in work/notebooks
    run: Path  # the checker's socket, the kernel's connection file

    @property
    def socket(self) -> Path:
        """The checker's."""
        return self.run / "checker"


# Where no machine has a Python, a ROS or a home.
IN_SANDBOX = Places(*(Path("/run/grading", name) for name in ("job", "work", "meeting")))


@functools.cache
def why_not() -> str:
    """Why no sandboxes can be made here, one in the other; nothing if they can."""
    if shutil.which("bwrap") is None:
        return "there is no bubblewrap here (`sudo apt-get install bubblewrap`)"
    command = [*outer(Path("/usr"), Limits()), *inner(IN_SANDBOX, {}, Limits()), sys.executable, "-I", "-c", ""]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=TRY_TIMEOUT)
    except (OSError, subprocess.TimeoutExpired) as error:
        return f"bubblewrap cannot be tried here: {error}"
    said = (done.stderr.strip().splitlines() or [f"status {done.returncode}"])[-1]
    return f"bubblewrap may not make sandboxes here: {said}" if done.returncode else ""


def is_available() -> bool:
    """Return True if sandboxes can be made here, one in the other."""
    return not why_not()


def limited(limits: Limits) -> list[str]:
    """What a command is put behind that has limits, in a sandbox or without."""
    # An answer that is refused memory keeps what it has from the next one; the grader's watch comes before that.
    options = [f"--fsize={limits.disk}", f"--data={2 * limits.memory}", f"--cpu={limits.processor}", "--core=0"]
    return ["prlimit", *options, "--"]


def outer(job: Path, limits: Limits) -> list[str]:
    """What a command is put behind that runs in the outer sandbox; `job` is the job's folder outside."""
    return [
        *("bwrap", "--unshare-net", "--unshare-pid", "--unshare-ipc", "--unshare-uts", "--die-with-parent"),
        *("--size", str(256 * MB), "--tmpfs", "/tmp", *_machine()),  # the course may lie in /tmp
        *("--proc", "/proc", "--dev", "/dev", "--size", str(256 * MB), "--perms", "1777", "--tmpfs", "/dev/shm"),
        *("--size", str(limits.disk), "--tmpfs", str(IN_SANDBOX.work)),
        *(word for name in ("notebooks", "home", "tmp") for word in ("--dir", str(IN_SANDBOX.work / name))),
        *("--dir", str(IN_SANDBOX.run), "--bind", str(job), str(IN_SANDBOX.job), "--chdir", str(IN_SANDBOX.job)),
    ]


def inner(places: Places, environ: Mapping[str, str], limits: Limits, only: bool = True) -> list[str]:
    """What a command is put behind that runs in an inner sandbox with this environment.

    `only`: with nothing else in it, and in the notebook's folder; else in that of the caller.
    """
    environ = {**environ, HIDDEN: "1"}  # the checker is out of sight, and shares /dev/shm
    environment = [word for name, value in sorted(environ.items()) for word in ("--setenv", name, value)]
    if only:
        environment = ["--chdir", str(places.work / "notebooks"), "--clearenv", *environment]
    work, meeting = str(places.work), str(places.run)
    # Signals that are meant for the program must not end bubblewrap, which waits for it.
    return [
        *("env", "--ignore-signal=INT", "bwrap", "--unshare-pid", "--unshare-ipc", "--unshare-uts"),
        *("--die-with-parent", "--cap-drop", "ALL", "--size", str(64 * MB), "--tmpfs", "/tmp", *_machine()),
        *("--proc", "/proc", *_SETTINGS, "--dev", "/dev", "--bind", "/dev/shm", "/dev/shm", "--remount-ro", "/dev"),
        *("--bind", work, work, "--ro-bind", meeting, meeting, "--remount-ro", "/", *environment, "--"),
        *(*limited(limits), "env", "--default-signal=INT"),
    ]


@functools.cache
def _machine() -> tuple[str, ...]:
    """The options that show what Python and ROS need of the machine, read-only, and nothing else of it.

    The course's package is there, with an empty folder in place of each one with solutions.
    """
    words: list[str] = []
    for name in ("usr", "bin", "sbin", "lib", "lib32", "lib64", "libx32"):
        path = Path("/", name)
        if path.is_symlink():
            words += ["--symlink", os.readlink(path), str(path)]
        elif path.is_dir():
            words += ["--ro-bind", str(path), str(path)]
    for path in [*(Path("/etc", name) for name in ETC), *_pythons()]:
        if path.exists() and not path.is_relative_to("/usr"):
            words += ["--ro-bind", str(path), str(path)]
    for path in {path for folder in worked.folders() for path in (folder, folder.resolve())}:
        words += ["--size", "4096", "--perms", "0555", "--tmpfs", str(path), "--remount-ro", str(path)]
    return tuple(words)


def _pythons() -> Iterator[Path]:
    """The environment, the Python that it was made of, the course's package, and a sourced ROS 2."""
    seen: list[Path] = []
    ros = sourced_ros(os.environ)
    executable = Path(sys.executable).resolve()
    for place in (sys.base_prefix, sys.prefix, executable.parents[1], Path(__file__).parents[2], ros and ros.prefix):
        if place and not any(Path(place).is_relative_to(one) for one in seen) and Path(place) != Path("/"):
            seen.append(Path(place))
            yield Path(place)
