"""The pinned versions of everything the course installs, read from requirements.lock.

Runs before anything is installed, so it uses the standard library alone:

    python course_kit/environment/pins.py             the lock, with hashes
    python course_kit/environment/pins.py --no-ros    the same without what comes with ROS 2 from apt
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

LOCK = Path(__file__).with_name("requirements.lock")
# What apt's ROS 2 depends on and so has brought, beside the wheels of ROS 2. Its colcon is a package that many do not
# install, so ours stays.
BROUGHT_BY_ROS = ("cmake", "ninja")


def blocks(text: str) -> Iterator[tuple[str, str]]:
    """Each requirement of a lock as (name, its lines: version, marker, hashes)."""
    name, lines = "", ""
    for line in text.splitlines(keepends=True):
        if line.startswith("#"):
            continue
        if not line.startswith(" "):
            if name:
                yield name, lines
            name, lines = line.partition("==")[0].partition("[")[0], ""
        lines += line
    if name:
        yield name, lines


def is_ros(name: str) -> bool:
    """Whether a package is one of the wheels of ROS 2, or comes with a ROS 2 from apt."""
    return name.startswith("ros-") or name in BROUGHT_BY_ROS


def requirements(with_ros: bool) -> list[str]:
    """Every pin as a requirement (PEP 508), without hashes."""
    return [
        lines.splitlines()[0].rstrip("\\ ") for name, lines in blocks(LOCK.read_text()) if with_ros or not is_ros(name)
    ]


def versions(names: Iterable[str]) -> list[str]:
    """The pins of some packages; KeyError if one is not in the lock."""
    pinned: dict[str, list[str]] = {}
    for requirement in requirements(with_ros=True):
        pinned.setdefault(requirement.partition("==")[0], []).append(requirement)
    return [requirement for name in names for requirement in pinned[name]]


if __name__ == "__main__":
    sys.stdout.write(
        "".join(lines for name, lines in blocks(LOCK.read_text()) if "--no-ros" not in sys.argv or not is_ros(name))
    )
