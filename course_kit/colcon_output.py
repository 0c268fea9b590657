"""What `colcon build` writes, line by line: which packages are built, which failed, and the lines that say why."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

# What a package that was built wrote to stderr is shown up to so many lines: warnings, mostly.
SHOWN_WARNINGS = 10
SHOWN_REASONS = 8
_DONE = re.compile(r"(Finished|Failed|Aborted)\s+<<< (\S+) \[(?:([\d.]+)s|(?:(\d+)min )?([\d.]+)s)(?:, (.*))?\]")
_BLOCK = re.compile(r"--- stderr: (\S+)")

_COMPILER = re.compile(r"(fatal )?error: |undefined reference to |ld: cannot find |multiple definition of ")
_CMAKE = re.compile(r"CMake Error")
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
    (r"error in \S+ setup command", "an argument of setup() in setup.py has a wrong form"),
    (r"([\w./]+\.hp?p?): No such file", "the compiler finds no {0}: does CMakeLists.txt name the package it is from?"),
    (r"File .*setup\.py", "setup.py itself is wrong: read the line that is named"),
    (r"No rule to make target|Cannot find source file", "CMakeLists.txt names a file that is not there"),
    (
        r"rosidl_adapter|rosidl_parser|\.msg|\.srv|\.action",
        "an interface file is wrong: fields are `type name`, names lower_case, constants UPPER_CASE",
    ),
)


@dataclass
class BuildOutput:
    """Takes the lines of a build; keeps all, gives those to show and, at the end, what happened."""

    lines: list[str] = field(default_factory=list)
    finished: dict[str, float] = field(default_factory=dict)  # package -> seconds
    failed: dict[str, str] = field(default_factory=dict)  # package -> how, as "exited with code 1"
    stderr: dict[str, list[str]] = field(default_factory=dict)  # package -> its lines
    _block: str = ""
    _waiting: set[str] = field(default_factory=set)

    def feed(self, line: str) -> list[str]:
        """Take a line; return the lines to show now: a package's messages come with its end, if it was built."""
        self.lines.append(line)
        if self._block:
            if line == "---":
                self._block = ""
            else:
                self.stderr[self._block].append(line)
            return []
        block = _BLOCK.fullmatch(line)
        if block:
            self._block = block[1]
            self.stderr.setdefault(block[1], [])
            self._waiting.add(block[1])
            return []
        done = _DONE.match(line)
        return [line] if done is None else self._end(done, line)

    def _end(self, done: re.Match[str], line: str) -> list[str]:
        word, package, seconds, minutes, rest, how = done.groups()
        if word == "Finished":
            self.finished[package] = float(seconds or rest) + 60 * int(minutes or 0)
            return [*self._warnings(package), line]
        if word == "Failed":
            self.failed[package] = how or "failed"
        return [line]

    def _warnings(self, package: str) -> list[str]:
        if package not in self._waiting:
            return []
        self._waiting.discard(package)
        lines = [line for line in self.stderr[package] if line.strip()]
        more = [f"  ... {len(lines) - SHOWN_WARNINGS} lines more"] if len(lines) > SHOWN_WARNINGS else []
        return [f"{package} was built, and said:", *(f"  {line}" for line in lines[:SHOWN_WARNINGS]), *more]

    def explanation(self) -> str:
        """The few lines that matter of a failed build: which package, what the tools say, what to do."""
        parts = []
        for package, how in self.failed.items():
            messages = self.stderr.get(package, [])
            parts += [f"✘ {package} was not built ({how})", *(f"    {line}" for line in reasons(messages))]
            what_to_do = advice(messages)
            parts += [f"  to do: {what_to_do}"] if what_to_do else []
            parts += [f"  all of it: log/latest_build/{package}/stdout_stderr.log"]
        return "\n".join(parts or ["✘ colcon build failed", *(f"    {line}" for line in self._last_words())])

    def _last_words(self) -> list[str]:
        errors = [line for line in self.lines if re.search(r"\berror\b", line, re.IGNORECASE)]
        return (errors or [line for line in self.lines if line.strip()])[-3:]


def reasons(lines: Sequence[str]) -> list[str]:
    """Of all that a failed package wrote to stderr, the lines that say why."""
    for pattern, cut in ((_COMPILER_LINE, _compiler_lines), (_CMAKE, _cmake_lines), (_PYTHON, _python_lines)):
        if any(pattern.match(line) for line in lines):
            return cut(lines)[:SHOWN_REASONS]
    return [line for line in lines if line.strip()][-3:]


_COMPILER_LINE = re.compile(rf"\S.*(?:{_COMPILER.pattern})")


def _compiler_lines(lines: Sequence[str]) -> list[str]:
    """Each error with the line of source below it."""
    found: list[str] = []
    for number, line in enumerate(lines):
        if _COMPILER_LINE.match(line) and "ld returned" not in line:
            found += [line, *(below for below in lines[number + 1 : number + 3] if re.match(r"\s+\d* \|", below))]
    return found


def _cmake_lines(lines: Sequence[str]) -> list[str]:
    """The first error's paragraphs, without the stack of calls."""
    first = next(number for number, line in enumerate(lines) if _CMAKE.match(line))
    found = [lines[first]]
    for line in lines[first + 1 :]:
        if line and not line.startswith(" "):
            break
        found += [line] if line.strip() else []
    return found


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
        found = re.search(pattern, text)
        if found:
            return cure.format(*found.groups())
    return ""
