"""Reads the output of `colcon build` line by line: packages that are built or failed, and why."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import takewhile
from pathlib import Path

# What a package that was built wrote to stderr is shown up to so many lines: warnings, mostly.
SHOWN_WARNINGS = 10
SHOWN_REASONS = 8
_STARTED = re.compile(r"Starting >>> (\S+)")
_DONE = re.compile(r"(Finished|Failed|Aborted)\s+<<< (\S+) \[(?:(\d+)min )?([\d.]+)s(?:, (.*))?\]")
_LOG = re.compile(r"\[[\d.]+s\] |\s*$")
# What colcon says about its own way of reading setup.py, after what setup.py itself has said.
_NOISE = re.compile(r"Command '\[|subprocess\.CalledProcessError")
_BLOCK = re.compile(r"--- stderr: (\S+)")

_COMPILER = re.compile(r"\S.*((fatal )?error: |undefined reference to |ld: cannot find |multiple definition of )")
_CMAKE = re.compile(r"CMake Error")
_INTERFACE = re.compile(r"\s*Error processing '")
# The last line of a Python traceback, or what setuptools says in place of one.
_PYTHON = re.compile(r"(?:[\w.]*(?:Error|Exception|Invalid\w+|Exit|Unknown\w+)\b(?:: |$)|error: |error in )")
_PYTHON_PLACE = re.compile(r'  File "(.*)", line \d+')

# What in a message names the cure.
ADVICE = (
    (r"provided by \"rclcpp\"", "rclcpp, the C++ library, is not among the wheels: build this beside ROS 2 from apt"),
    (
        r"package configuration file provided by\s+\"(\w+)\"",
        "find_package({0}) finds no {0}: is it spelt so, named in package.xml as <depend>, and in src/ or installed?",
    ),
    (r"CMAKE_C(?:XX)?_COMPILER", "there is no C++ compiler: sudo apt-get install -y g++"),
    (r"Python\.h|Python3_INCLUDE_DIR|Development", "Python's headers are missing: sudo apt-get install -y python3-dev"),
    (r"package directory '(\S+)' does not exist", "setup.py lists the package {0}, but src has no folder of that name"),
    (r"can't copy '(\S+)'", "data_files in setup.py names {0}, which is not there"),
    (
        r"error in \S+ setup command|setup\(\)' was never called",
        "an argument of setup() in setup.py has a wrong form; entry points are 'name = package.module:function'",
    ),
    (r"([\w./]+\.hp?p?): No such file", "the compiler finds no {0}: does CMakeLists.txt name the package it is from?"),
    (r'File "setup.py"', "setup.py itself is wrong: read the line that is named"),
    (r"No rule to make target|Cannot find source file", "CMakeLists.txt names a file that is not there"),
    (
        r"pkg_dir = include_map(?s:.*)KeyError: '(\w+)'",
        "an interface uses a type of {0}: name it in CMakeLists.txt, in find_package() and DEPENDENCIES",
    ),
    (
        r"Error processing|is an invalid|rosidl_adapter|rosidl_parser",
        "a .msg, .srv or .action file is wrong: `type name` or `type NAME=value`, types of messages in UpperCase",
    ),
)


@dataclass(repr=False)
class Build:
    """What a `colcon build` did. Takes the lines that it writes, keeps all, and gives those to show."""

    lines: list[str] = field(default_factory=list)  # all that it wrote
    finished: dict[str, float] = field(default_factory=dict)  # package -> seconds
    failed: dict[str, str] = field(default_factory=dict)  # package -> how, as "exited with code 1"
    messages: dict[str, list[str]] = field(default_factory=dict)  # package -> what its tools said
    status: int | None = None  # its exit status, once it has ended
    seconds: float = 0.0
    _block: str = ""  # the package whose stderr is being listed
    under_way: list[str] = field(default_factory=list)  # the packages that are being built
    _loose: list[str] = field(default_factory=list)  # written past colcon by a package that is not known yet
    _loose_of: dict[str, list[str]] = field(default_factory=dict)

    @property
    def ok(self) -> bool:
        """True if all was built."""
        return self.status == 0

    def __repr__(self) -> str:
        return f"{len(self.finished)} built, {len(self.failed)} failed, {self.seconds:.1f} s"

    def feed(self, line: str) -> list[str]:
        """Take a line; return the lines to show now: a package's messages come with its end, if it was built."""
        self.lines.append(line)
        if self._block:
            if line == "---":
                self._block = ""
            else:
                self.messages[self._block].append(line)
            return []
        if block := _BLOCK.fullmatch(line):
            self._block = block[1]
            self.messages.setdefault(block[1], [])
            return []
        if started := _STARTED.fullmatch(line):
            self.under_way.append(started[1])
            return [line]
        if done := _DONE.match(line):
            return self._end(done, line)
        if self.under_way and not _LOG.match(line):
            self._loose.append(line)
            return []
        return [] if _NOISE.match(line) else [line]

    def _end(self, done: re.Match[str], line: str) -> list[str]:
        word, package, minutes, seconds, how = done.groups()
        if package in self.under_way:
            self.under_way.remove(package)
        self._loose_of[package], self._loose = self._loose, []
        messages = self.messages[package] = [*self._loose_of[package], *self.messages.get(package, [])]
        if word == "Finished":
            self.finished[package] = float(seconds) + 60 * int(minutes or 0)
            return [*_warnings(package, messages), line]
        if word == "Failed":
            self.failed[package] = how or "failed"
        return [line]

    def read_log(self, package: str, lines: Sequence[str]) -> None:
        """Take the log of a package, which has more than the console: ninja tells compiler errors on stdout."""
        self.messages[package] = [*self._loose_of.get(package, []), *lines]

    def explanation(self) -> str:
        """The few lines that matter of a failed build: which package, what the tools say, what to do."""
        parts = []
        for package, how in self.failed.items():
            why = reasons(self.messages.get(package, []))
            parts += [f"✘ {package} was not built ({how})", *(f"    {line}" for line in why[:SHOWN_REASONS])]
            what_to_do = advice(why)
            parts += [f"  to do: {what_to_do}"] if what_to_do else []
            parts += [f"  all of it: log/latest_build/{package}/stdout_stderr.log"]
        return "\n".join(parts or ["✘ colcon build did not start", *(f"    {line}" for line in self._last_words())])

    def _last_words(self) -> list[str]:
        errors = [line for line in self.lines if re.search(r"\berror\b", line, re.IGNORECASE)]
        return (errors or [line for line in self.lines if line.strip()])[-3:]


def queued(events: Path) -> int | None:
    """How many packages a `colcon build` has to build, from its log of events; None where there is none."""
    with contextlib.suppress(OSError):
        return events.read_text(encoding="utf-8", errors="replace").count(" JobQueued: ")
    return None


def _warnings(package: str, messages: Sequence[str]) -> list[str]:
    """What a package that was built had to say."""
    lines = [f"  {line}" for line in messages if line.strip()]
    if not lines:
        return []
    more = [f"  ... {len(lines) - SHOWN_WARNINGS} lines more"] if len(lines) > SHOWN_WARNINGS else []
    return [f"{package} was built, and said:", *lines[:SHOWN_WARNINGS], *more]


def reasons(lines: Sequence[str]) -> list[str]:
    """Of all that the tools of a failed package said, the lines that say why."""
    lines = [line.replace('"<string>"', '"setup.py"') for line in lines if not _NOISE.match(line)]
    for pattern, cut in (
        (_INTERFACE, _interface_lines),
        (_COMPILER, _compiler_lines),
        (_CMAKE, _cmake_lines),
        (_PYTHON, _python_lines),
    ):
        if any(pattern.match(line) for line in lines):
            return cut(lines)
    return [line for line in lines if line.strip()][-3:]


def _interface_lines(lines: Sequence[str]) -> list[str]:
    """The sentence about the line of an interface file that is wrong."""
    first = next(number for number, line in enumerate(lines) if _INTERFACE.match(line))
    rest = [line.strip() for line in lines[first:]]
    return [" ".join(rest[: rest.index("")] if "" in rest else rest)]


def _compiler_lines(lines: Sequence[str]) -> list[str]:
    """Each error with the line of source below it."""
    found: list[str] = []
    for number, line in enumerate(lines):
        if _COMPILER.match(line) and "ld returned" not in line:
            found += [line, *(below for below in lines[number + 1 : number + 3] if re.match(r"\s+\d* \|", below))]
    return found


def _cmake_lines(lines: Sequence[str]) -> list[str]:
    """The first error's paragraphs, without the stack of calls."""
    first = next(number for number, line in enumerate(lines) if _CMAKE.match(line))
    below = takewhile(lambda line: not line or line.startswith(" "), lines[first + 1 :])
    found = [lines[first], *filter(str.strip, below)]
    errors = [line.strip() for line in found if _PYTHON.match(line.strip())]
    return errors[-1:] if any(line.strip().startswith("Traceback ") for line in found) and errors else found


def _python_lines(lines: Sequence[str]) -> list[str]:
    """The last error, and for one in a file the place and the line of it."""
    last = max(number for number, line in enumerate(lines) if _PYTHON.match(line))
    places = [number for number in range(last) if _PYTHON_PLACE.match(lines[number])]
    place = places[-1] if places and "Error" in lines[last] else last
    return [line.strip() if number < last else line for number, line in enumerate(lines[: last + 1]) if number >= place]


def advice(lines: Sequence[str]) -> str:
    """What to do about it, or nothing if the messages must do."""
    text = "\n".join(lines)
    for pattern, cure in ADVICE:
        if found := re.search(pattern, text):
            return cure.format(*found.groups())
    return ""
