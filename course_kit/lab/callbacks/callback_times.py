"""When callbacks began and ended, and in which thread, as programs print it. Pure: no ROS.

A program prints `callback NAME THREAD BEGAN ENDED` for each callback that it has run, times in seconds, and, if idle
threads are to be seen as well, `threads NUMBER`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

CALLBACK = re.compile(r"callback (\w+) (\S+) (\d+\.?\d*) (\d+\.?\d*)")
THREADS = re.compile(r"threads (\d+)")


@dataclass(frozen=True)
class Span:
    """One call of a callback; `thread` counts from 1, in the order in which threads got their first one. Seconds."""

    name: str
    thread: int
    began: float
    ended: float


@dataclass(frozen=True)
class Run:
    """What one program has told of its callbacks, by their beginning."""

    spans: tuple[Span, ...]
    threads: int


def run_of(lines: Iterable[str]) -> Run:
    """What the lines of a program say. ValueError if they name no callback."""
    told, threads = [], 0
    for line in lines:
        if match := CALLBACK.fullmatch(line.strip()):
            told.append((float(match[3]), float(match[4]), match[1], match[2]))
        elif match := THREADS.fullmatch(line.strip()):
            threads = int(match[1])
    if not told:
        raise ValueError("the program has printed no line `callback NAME THREAD BEGAN ENDED`")
    numbers: dict[str, int] = {}
    spans = [
        Span(name, numbers.setdefault(thread, len(numbers) + 1), began, ended)
        for began, ended, name, thread in sorted(told)
    ]
    return Run(tuple(spans), max(threads, len(numbers)))
