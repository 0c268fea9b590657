"""Which part of a traceback is the student's: without the course's own frames, rclpy's and those of messages."""

from __future__ import annotations

import contextlib
import sysconfig
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType

PACKAGE = Path(__file__).parents[2]
LIBRARIES = tuple(Path(sysconfig.get_path(name)) for name in ("stdlib", "purelib", "platlib"))


def steps(traceback: TracebackType | None) -> Iterator[TracebackType]:
    """The steps of a traceback, the innermost last."""
    while traceback is not None:
        yield traceback
        traceback = traceback.tb_next


def is_plumbing(path: Path) -> bool:
    """Return True if a file is the course's, rclpy's, or one of those that messages are generated into."""
    is_generated = path.name.startswith("_") and path.parent.name in ("msg", "srv", "action")
    return path.is_relative_to(PACKAGE) or "rclpy" in path.parts or is_generated


def is_library(path: Path) -> bool:
    """Return True if a file is of Python's standard library or of an installed package."""
    is_source = path.is_absolute()  # "<frozen …>" is not, nor is what Cython has compiled
    return not is_source or any(path.is_relative_to(one) for one in LIBRARIES)


def without_plumbing(traceback: TracebackType | None, interrupted: bool = False) -> TracebackType | None:
    """A traceback without the course's and rclpy's frames, and without the library calls that those make.

    Of an interrupt all library calls are left out: where exactly it came, nobody needs to know.
    """
    kept: list[TracebackType] = []
    inside = False
    for step in steps(traceback):
        path = Path(step.tb_frame.f_code.co_filename)
        inside = is_plumbing(path) or (is_library(path) and (inside or interrupted))
        if not inside:
            kept.append(step)
    result: TracebackType | None = None
    for step in reversed(kept):
        result = TracebackType(result, step.tb_frame, step.tb_lasti, line_of(step))
    return result


def line_of(step: TracebackType) -> int:
    """The number of the line that a step stands in.

    An interrupt may come at an instruction that belongs to no line: then the first line of its function.
    """
    line: int | None = step.tb_lineno  # None or, in Debian 12's Python 3.11.2, -1: typeshed says neither
    return line if line and line > 0 else step.tb_frame.f_code.co_firstlineno


@contextlib.contextmanager
def folded(error: BaseException) -> Iterator[None]:
    """Within the block, the tracebacks of an error and of those that led to it have the student's frames alone."""
    with contextlib.ExitStack() as restoring:
        seen: list[BaseException] = []
        waiting: list[BaseException | None] = [error]
        while waiting:
            one = waiting.pop()
            if one is None or any(one is other for other in seen):
                continue
            seen.append(one)
            waiting += [one.__cause__, one.__context__]
            restoring.callback(setattr, one, "__suppress_context__", one.__suppress_context__)
            restoring.callback(setattr, one, "__traceback__", one.__traceback__)
            interrupted = isinstance(one, KeyboardInterrupt)
            one.__traceback__ = without_plumbing(one.__traceback__, interrupted)
            before = one.__context__
            if before is not None and without_plumbing(before.__traceback__, interrupted) is None:
                one.__suppress_context__ = True  # the course or a library has met it, and gone on
        yield
