"""Types of the checker's own for exercises about types that a student builds: compiled once, then kept.

The checker loads nothing from a student's workspace. A package of the same definitions speaks with the student's, as
DDS compares names only, if the fields have the same order: where a task leaves that open, the checker's own text is
rearranged. What is compiled lies with the course's own files, which an answer has no business with.
"""

from __future__ import annotations

import atexit
import contextlib
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
from collections.abc import Mapping
from pathlib import Path

from course_kit.base.atomic_files import NotWritten
from course_kit.base.file_locks import LockTimeout, locked
from course_kit.exercises.checker.definitions import arranged
from course_kit.setup.colcon import chapter_packages, overlay, regular_files
from course_kit.setup.interfaces import rosidl

# Where the definitions are, and which of them checks need.
DEFINITIONS = {
    "my_interfaces": (chapter_packages.FOLDER / "my_interfaces", ("action/Polygon.action",)),
    "robot_interfaces": (Path(__file__).with_name("robot_interfaces"), ("msg/Battery.msg", "srv/Recharge.srv")),
}
COMPILE_TIMEOUT = 120.0
LOCK_TIMEOUT = COMPILE_TIMEOUT - 10.0  # seconds: who has the lock compiles; it is said before the checker is given up
RELOAD = "{package} has its fields in another order now. Restart the kernel, as for your own"
FOLDER = "share/course_kit/checker_types"


class Uncompiled(RuntimeError):  # noqa: N818  (reads as what happened)
    """The types could not be compiled; its text says why."""


Texts = Mapping[str, str]  # definitions by their file


def own_texts(package: str, workspace: Path | None = None) -> Texts:
    """The definitions that a package is compiled from; with their fields in the order that a workspace has installed.

    What is installed there counts as far as it says the same otherwise.
    """
    source, files = DEFINITIONS[package]
    texts = {file: (source / file).read_text() for file in files}
    if workspace is None:
        return texts
    share = overlay.prefix_of(workspace, package) / "share" / package
    return {file: _in_order(regular_files.text_of(share / file) or "", text) for file, text in texts.items()}


def _in_order(installed: str, text: str) -> str:
    ordered = arranged(installed, text)
    return text if ordered in (None, arranged(text, text)) else str(ordered)


def is_ready(package: str, texts: Texts | None = None) -> bool:
    """Return True if a package is compiled; unless given, from the course's own definitions."""
    return folder_of(package, texts or own_texts(package)).is_dir()


def provide(package: str, texts: Texts | None = None) -> None:
    """Have a package importable; compiles it if need be, which takes some ten seconds. Raises Uncompiled."""
    texts = texts or own_texts(package)
    folder = folder_of(package, texts)
    if not folder.is_dir():
        try:
            with locked(folder.with_suffix(".lock"), LOCK_TIMEOUT):  # two notebooks may need it at the same time
                if not folder.is_dir():
                    _compile(package, texts, folder)
        except (LockTimeout, NotWritten) as error:
            raise Uncompiled(f"the types of {package} cannot be compiled: {error}") from None
        except OSError as error:
            raise Uncompiled(f"the types of {package} cannot be kept in {folder.parent}: {error.strerror}") from None
    loaded = getattr(sys.modules.get(package), "__file__", None)
    if loaded and not Path(loaded).is_relative_to(folder):  # its libraries stay as long as the process
        raise Uncompiled(RELOAD.format(package=package))
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))
        importlib.invalidate_caches()


def folder_of(package: str, texts: Texts) -> Path:
    """Named by all that decides what the compiler makes."""
    prefix = rosidl.ros_prefix()
    parts = [
        *(f"{name}\n{text}" for name, text in texts.items()),
        Path(str(rosidl.__file__)).read_text(),
        (prefix / "share/rosidl_generator_py/package.xml").read_text(),
        f"{prefix} {sys.implementation.cache_tag} {platform.machine()} {importlib.metadata.version('numpy')}",
    ]
    digest = hashlib.sha256("\0".join(parts).encode()).hexdigest()[:16]
    # A grader's checker may read what was compiled before, and write nothing beside it.
    kept = base() / f"{package}-{digest}"
    return kept if kept.is_dir() or _is_writable(base()) else _own() / kept.name


def base() -> Path:
    """Where they are kept: with the course."""
    return Path(sys.prefix, FOLDER)


def _is_writable(folder: Path) -> bool:
    with contextlib.suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
        return os.access(folder, os.W_OK)
    return False


@functools.cache
def _own() -> Path:
    """Where they are for as long as this process lives, if they may not be kept with the course."""
    own = tempfile.mkdtemp(prefix="course-kit-types-")
    atexit.register(shutil.rmtree, own, ignore_errors=True)
    return Path(own)


def _compile(package: str, texts: Texts, folder: Path) -> None:
    """Compile into a folder that then gets its name: it is there as a whole, or not at all."""
    with tempfile.TemporaryDirectory(dir=folder.parent) as work:
        for name, text in texts.items():
            (copy := Path(work, package, name)).parent.mkdir(parents=True, exist_ok=True)
            copy.write_text(text)
        # In a process of its own: the generators fork, which one with threads must not.
        command = [sys.executable, "-I", "-m", "course_kit.exercises.checker.own_types", package, work]
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
    """Compile FOLDER/PACKAGE to FOLDER/made/PACKAGE; PACKAGE and FOLDER are the arguments of the program."""
    package, work = sys.argv[1], Path(sys.argv[2])
    built = rosidl.build({package: work / package}, work / "work")
    shutil.copytree(built[package], work / "made" / package, ignore=shutil.ignore_patterns("*.c", "*.h"))


if __name__ == "__main__":
    main()
