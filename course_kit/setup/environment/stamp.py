"""Tells if the course's .venv is finished and fits: set-up leaves a stamp in it, every start compares.

Runs with a bare Python and quickly, for it is part of every start:

    python -m course_kit.setup.environment.stamp state LEVEL      one of the states below
    python -m course_kit.setup.environment.stamp level LEVEL      what a set-up for LEVEL makes: no lower one
    python -m course_kit.setup.environment.stamp download LEVEL   the MB that it downloads
    python -m course_kit.setup.environment.stamp digest           the stamp of a finished .venv, without its level
"""

from __future__ import annotations

import hashlib
import os
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

from course_kit.setup.environment.activation import sourced_ros
from course_kit.setup.environment.levels import LEVELS, STUDENT, download, higher

ROOT = Path(__file__).resolve().parents[3]
NAME = "course-kit-stamp"
READY = "ready"
BELOW = "below"  # ready for a lower level: packages have to be added, and none changed
MISSING = "missing"
UNFINISHED = "unfinished"  # set-up was interrupted, or still runs
OUTDATED = "outdated"  # made for other versions, another Python, another ROS 2 or another folder
FOREIGN = "foreign"  # made by the user, with `pip install -e .`
INCOMPLETE = "incomplete"  # made by the user, without the course in it
USABLE = (READY, FOREIGN)


def sources(root: Path) -> Iterator[Path]:
    """The files that decide what set-up makes."""
    kit = root / "course_kit"
    yield root / "pyproject.toml"
    yield from (
        kit / "setup/environment" / name for name in ("requirements.lock", "compiler.py", "levels.py", "pins.py")
    )
    yield from (
        kit / "setup/interfaces" / name for name in ("build_hook.py", "course_kit_environment.pth", "rosidl.py")
    )
    yield kit / "base/shutdown/watchdog.c"
    for folder in (
        kit / "setup/environment/prefix",
        *(p.parent for p in sorted(kit.glob("setup/interfaces/*/package.xml"))),
    ):
        yield from sorted(p for p in folder.rglob("*") if p.is_file() and p.parent.name != "__pycache__")


def digest(root: Path, environ: Mapping[str, str], python: tuple[int, int]) -> str:
    """One line for all that a finished .venv depends on, its own place included: it cannot be moved."""
    found = hashlib.sha256()
    ros = sourced_ros(environ)
    for part in (root, ros.prefix if ros else "", *python):
        found.update(f"{part}\0".encode())
    for path in sources(root):
        found.update(f"{path.relative_to(root)}\0".encode() + path.read_bytes() + b"\0")
    return found.hexdigest()


def read(venv: Path) -> tuple[str, str]:
    """The stamp in an environment: UNFINISHED or a digest, and a level. OSError if there is none."""
    words = (venv / NAME).read_text().split()
    return words[0] if words else UNFINISHED, words[1] if words[1:] and words[1] in LEVELS else STUDENT


def level_of(venv: Path) -> str:
    """The level of an environment, finished or outdated; the lowest if set-up has not made it."""
    try:
        return read(venv)[1]
    except OSError:
        return STUDENT


def state(root: Path, environ: Mapping[str, str], python: tuple[int, int], level: str = STUDENT) -> str:
    """What there is in .venv, for a course at some level that runs on this version of Python."""
    venv = root / ".venv"
    if not venv.is_dir() or not any(venv.iterdir()):
        return MISSING
    try:
        stamp, there = read(venv)
    except OSError:
        installed = any(venv.glob("lib/python3.*/site-packages/ros2_notebook_course-*.dist-info"))
        return FOREIGN if installed else INCOMPLETE
    if stamp == UNFINISHED:
        return UNFINISHED
    if stamp != digest(root, environ, python):
        return OUTDATED
    return READY if higher(there, level) == there else BELOW


def main(question: str, level: str = STUDENT) -> object:
    """Answer a question of the script."""
    here = ROOT, os.environ, sys.version_info[:2]
    there = level_of(ROOT / ".venv")
    if question == "state":
        return state(*here, level)
    if question == "level":
        return higher(there, level)
    if question == "download":
        return download(level, there if state(*here, level) == BELOW else "")
    return digest(*here)


if __name__ == "__main__":
    print(main(*sys.argv[1:]))
