"""The digest of everything that a verdict depends on: a class run keeps its results under it. Pure: no ROS."""

from __future__ import annotations

import functools
import hashlib
import importlib.metadata
import os
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

from course_kit.setup.environment import pins
from course_kit.setup.environment.activation import sourced_ros
from course_kit.setup.environment.levels import GRADING

KIT = Path(__file__).parents[2]


@functools.cache
def course_digest() -> str:
    """Return the digest of the course on this machine."""
    return digest(KIT, os.environ)


def digest(kit: Path, environ: Mapping[str, str]) -> str:
    """Return the digest of the course's files in `kit`, and of the versions of Python, packages and ROS 2.

    The files are modules, worlds, interfaces, the DDS profile and the lock. Worked solutions and copies of notebooks,
    which only some editions have, are left out. `environ` names the ROS 2 that is sourced, if one is.
    """
    found = hashlib.sha256()
    for path in _files(kit):
        found.update(f"{path.relative_to(kit)}\0".encode() + path.read_bytes() + b"\0")
    for line in (*_versions(), *_of_ros(environ)):
        found.update(f"{line}\0".encode())
    return found.hexdigest()


def _files(kit: Path) -> Iterator[Path]:
    for path in sorted(kit.rglob("*")):
        if path.is_file() and path.suffix not in (".md", ".ipynb") and "__pycache__" not in path.parts:
            yield path


def _versions() -> Iterator[str]:
    """Yield the version of Python, and of each pinned package that is installed."""
    yield sys.version
    for name in sorted(pins.packages(GRADING)):
        try:
            yield f"{name} {importlib.metadata.version(name)}"
        except importlib.metadata.PackageNotFoundError:  # of another machine, or apt's ROS 2 has it
            continue


def _of_ros(environ: Mapping[str, str]) -> Iterator[str]:
    """Yield the packages of a sourced ROS 2, with their versions."""
    if ros := sourced_ros(environ):
        for path in sorted(Path(ros.prefix, "share").glob("*/package.xml")):
            yield path.read_text(encoding="utf-8", errors="replace")
