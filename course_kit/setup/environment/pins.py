"""The pinned versions of everything the course installs, read from requirements.lock.

Runs before anything is installed, so it uses the standard library alone:

    python -m course_kit.setup.environment.pins LEVEL    the part of the lock that a level installs here, with hashes
"""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from course_kit.setup.environment import compiler
from course_kit.setup.environment.activation import sourced_ros
from course_kit.setup.environment.levels import LEVELS, STUDENT, up_to

LOCK = Path(__file__).with_name("requirements.lock")
REQUIREMENT = r"^(([\w.-]+).*\n(?: .*\n)*)"  # its name, version and marker; below, its hashes and what needs it
NEEDED_BY = r"^ +#(?: via)? +([\w.-]+)(?: \(pyproject\.toml:(\w+)\))?$"  # a package; or the course, and its group
# What apt's ROS 2 depends on and so has brought, beside the wheels of ROS 2. Its colcon is a package that many do not
# install, so ours stays.
BROUGHT_BY_ROS = ("cmake", "ninja")


def is_ros(name: str) -> bool:
    """Return True if a package is one of the wheels of ROS 2, or comes with a ROS 2 from apt."""
    return name.startswith("ros-") or name in BROUGHT_BY_ROS


def compiler_is_wanted(environ: Mapping[str, str]) -> bool:
    """Return True if the compiler in a wheel is needed: the machine has none, and ROS 2 is not one from apt."""
    return sourced_ros(environ) is None and compiler.of_the_machine(environ) is None


def packages(level: str) -> set[str]:
    """The names of all that a level installs: its groups and those of lower levels, and what these need."""
    needed_by: dict[str, set[str]] = {}
    for lines, name in re.findall(REQUIREMENT, LOCK.read_text(), re.MULTILINE):
        found = re.findall(NEEDED_BY, lines, re.MULTILINE)
        needed_by.setdefault(name, set()).update(f"group {group}" if group else parent for parent, group in found)
    wanted = {f"group {group}" for one in up_to(level) for group in LEVELS[one]}
    names: set[str] = set()
    while more := {name for name, parents in needed_by.items() if name not in names and parents & (wanted | names)}:
        names |= more
    return names


def installed(with_ros: bool, with_compiler: bool, level: str = STUDENT) -> Iterator[str]:
    """Each requirement of the lock that is meant for a machine and a level, with the lines below it."""
    names = packages(level)
    for lines, name in re.findall(REQUIREMENT, LOCK.read_text(), re.MULTILINE):
        if name in names and (with_ros or not is_ros(name)) and (with_compiler or name != compiler.WHEEL):
            yield lines


def requirements(with_ros: bool, with_compiler: bool = False, level: str = STUDENT) -> list[str]:
    """Every pin of a level as a requirement (PEP 508), without hashes."""
    return [lines.splitlines()[0].rstrip("\\ ") for lines in installed(with_ros, with_compiler, level)]


def added(level: str) -> list[str]:
    """The pins that a level has and a student's environment has not, as requirements."""
    of_students = set(requirements(with_ros=True, with_compiler=True))
    return [pin for pin in requirements(with_ros=True, with_compiler=True, level=level) if pin not in of_students]


def versions(names: Iterable[str]) -> list[str]:
    """The pins of some packages; KeyError if one is not in the lock."""
    pinned: dict[str, list[str]] = {}
    for requirement in requirements(with_ros=True, with_compiler=True):
        pinned.setdefault(requirement.partition("==")[0], []).append(requirement)
    return [requirement for name in names for requirement in pinned[name]]


if __name__ == "__main__":
    here = sourced_ros(os.environ) is None, compiler_is_wanted(os.environ)
    sys.stdout.write("".join(installed(*here, level=sys.argv[1])))
