"""Parts of other libraries that are no public interface of theirs: one module for each library, and nowhere else.

Each module looks at the first use whether the parts are as expected, and raises NotAsExpected where they are not: who
uses them says what does not work here, once, and goes on without them where that can be.
"""

from __future__ import annotations

import contextlib
import os
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

# The releases of rclpy that the tests ran with, as package.xml has them: that of the wheel 7.1.6 says 7.1.5.
TRIED_RCLPY = ("7.1.5", "7.1.6")

_said: set[str] = set()
_held: list[str] | None = None  # lines that wait for release(), if they wait


class NotAsExpected(RuntimeError):  # noqa: N818  (reads as what is found)
    """A part of another library is not what the course stands on; the text says in one line what differs."""


def expect(library: str, owner: Any, *names: str) -> None:
    """Raise NotAsExpected unless a class, a module or an object of a library has these attributes."""
    missing = [name for name in names if not hasattr(owner, name)]
    if missing:
        raise NotAsExpected(f"{library} has no {getattr(owner, '__name__', type(owner).__name__)}.{missing[0]} here")


@contextlib.contextmanager
def going_on_without(consequence: str) -> Iterator[None]:
    """Where a part that the block uses is not as expected, leave the block and say what does not work for that."""
    try:
        yield
    except NotAsExpected as error:
        say(f"{error}: {consequence}")


def say(line: str) -> None:
    """Print a line on stderr, once in a process: what does not work here, and why."""
    if line in _said:
        return
    _said.add(line)
    if _held is None:
        print(f"course_kit: {line}", file=sys.stderr)
    else:
        _held.append(line)


def hold() -> None:
    """Have say() wait until release(): what a kernel says before its first cell, nobody sees."""
    global _held
    _held = []


def release() -> None:
    """Say what waits, and from now on at once."""
    global _held
    waiting, _held = _held or [], None
    for line in waiting:
        print(f"course_kit: {line}", file=sys.stderr)


def package_version(package: str) -> str:
    """The version of a ROS package, from its package.xml; '' where there is none."""
    for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        with contextlib.suppress(OSError):
            text = Path(prefix, "share", package, "package.xml").read_text(encoding="utf-8")
            found = re.search(r"<version[^>]*>\s*([\w.]+)\s*</version>", text)
            return found[1] if found else ""
    return ""


def untried(version: str) -> str:
    """What to say of a release of rclpy that the tests did not run with; '' for the others."""
    if version in TRIED_RCLPY:
        return ""
    return f"the course was tried with rclpy {TRIED_RCLPY[-1]}; what does not work with {version or 'this one'} says so"
