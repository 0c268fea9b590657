"""Types of the checker's own for exercises about types that a student builds: compiled once, then kept.

The checker loads nothing from a student's workspace. A package of the same definitions speaks with the student's, as
DDS compares names only. What is compiled lies with the course's own files, which an answer has no business with.
"""

from __future__ import annotations

import atexit
import contextlib
import fcntl
import functools
import hashlib
import importlib
import importlib.metadata
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from course_kit.interfaces import rosidl

HERE = Path(__file__).parents[1]
# Where the definitions are, and which of them checks need.
DEFINITIONS = {
    "my_interfaces": (HERE / "colcon/chapter_packages/my_interfaces", ("action/Polygon.action",)),
    "robot_interfaces": (HERE / "exercises/robot_interfaces", ("msg/Battery.msg", "srv/Recharge.srv")),
}
COMPILE_TIMEOUT = 120.0
FOLDER = "share/course_kit/checker_types"


class Uncompiled(RuntimeError):  # noqa: N818  (reads as what happened)
    """The types could not be compiled; its text says why."""


def is_ready(package: str) -> bool:
    """Whether a package is compiled."""
    return _folder(package).is_dir()


def provide(package: str) -> None:
    """Have a package importable; compiles it if need be, which takes some ten seconds. Raises Uncompiled."""
    folder = _folder(package)
    if not folder.is_dir():
        try:
            folder.parent.mkdir(parents=True, exist_ok=True)
            with open(folder.with_suffix(".lock"), "w") as lock:
                fcntl.flock(lock, fcntl.LOCK_EX)  # two notebooks may need it at the same time
                if not folder.is_dir():
                    _compile(package, folder)
        except OSError as error:
            raise Uncompiled(f"the types of {package} cannot be kept in {folder.parent}: {error.strerror}") from None
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))
        importlib.invalidate_caches()


def _folder(package: str) -> Path:
    """Named by all that decides what the compiler makes."""
    source, files = DEFINITIONS[package]
    prefix = rosidl.ros_prefix()
    parts = [
        *(f"{name}\n{(source / name).read_text()}" for name in files),
        Path(str(rosidl.__file__)).read_text(),
        (prefix / "share/rosidl_generator_py/package.xml").read_text(),
        f"{prefix} {sys.implementation.cache_tag} {platform.machine()} {importlib.metadata.version('numpy')}",
    ]
    digest = hashlib.sha256("\0".join(parts).encode()).hexdigest()[:16]
    return base() / f"{package}-{digest}"


@functools.cache
def base() -> Path:
    """Where they are kept: with the course, or where that may not be written, for as long as this process lives."""
    folder = Path(sys.prefix, FOLDER)
    with contextlib.suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
        if os.access(folder, os.W_OK):
            return folder
    own = tempfile.mkdtemp(prefix="course-kit-types-")
    atexit.register(shutil.rmtree, own, ignore_errors=True)
    return Path(own)


def _compile(package: str, folder: Path) -> None:
    """Compile into a folder that then gets its name: it is there as a whole, or not at all."""
    source, files = DEFINITIONS[package]
    with tempfile.TemporaryDirectory(dir=folder.parent) as work:
        for name in files:
            (copy := Path(work, package, name)).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(source / name, copy)
        # In a process of its own: the generators fork, which one with threads must not.
        command = [sys.executable, "-I", "-m", "course_kit.examining.own_types", package, work]
        done: subprocess.CompletedProcess[str] | None = None
        with contextlib.suppress(subprocess.TimeoutExpired):
            done = subprocess.run(
                command, cwd="/", stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=COMPILE_TIMEOUT
            )
        if done is None or done.returncode:
            said = (done.stderr.strip().splitlines() if done is not None else []) or ["it took too long"]
            raise Uncompiled(f"compiling the types of {package} failed: {said[-1]}")
        Path(work, "made").rename(folder)


def main() -> None:
    """`python -m course_kit.examining.own_types PACKAGE FOLDER`: compile FOLDER/PACKAGE to FOLDER/made/PACKAGE."""
    package, work = sys.argv[1], Path(sys.argv[2])
    built = rosidl.build({package: work / package}, work / "work")
    shutil.copytree(built[package], work / "made" / package, ignore=shutil.ignore_patterns("*.c", "*.h"))


if __name__ == "__main__":
    main()
