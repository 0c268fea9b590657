"""Signals that ask a program to end in good order: which they are, and how it ends well all the same."""

from __future__ import annotations

import contextlib
import os
import signal
import stat
import threading
from collections.abc import Callable, Iterator
from typing import TypeVar

Made = TypeVar("Made")


def asking_to_end() -> list[signal.Signals]:
    """SIGTERM, and SIGHUP, which comes from a terminal that closes, unless `nohup` has it ignored."""
    hears_terminal = signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN
    return [signal.SIGTERM, *([signal.SIGHUP] if hears_terminal else [])]


def leave_closed_terminal() -> None:
    """Send stdout and stderr nowhere if their terminal has closed: each line would be an OSError amid a good end."""
    for output in (1, 2):
        with contextlib.suppress(OSError):  # closed
            if stat.S_ISCHR(os.fstat(output).st_mode) and not os.isatty(output):
                write_nowhere(output)


def write_nowhere(output: int) -> None:
    """Send an output, 1 or 2, nowhere from now on: the reader of its pipe, or its terminal, has gone."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, output)
    os.close(nowhere)


@contextlib.contextmanager
def put_off() -> Iterator[None]:
    """Have Ctrl-C and the signals that ask to end wait until the block is done.

    A node that is interrupted while it is made belongs to nobody: nobody ends it, and its shared memory stays.
    """
    came: list[int] = []
    before = {}
    if threading.current_thread() is threading.main_thread():  # Python's signal handlers run in no other
        for number in (signal.SIGINT, *asking_to_end()):
            before[number] = signal.signal(number, lambda number, _: came.append(number))
    try:
        yield
    finally:
        for each, handler in before.items():
            signal.signal(each, handler)
        if came:
            signal.raise_signal(came[0])


def whole(make: Callable[[], Made], end: Callable[[Made], object]) -> Made:
    """Make something in a short time. Ctrl-C waits, and then ends it: the caller has nothing to end."""
    made: list[Made] = []
    try:
        with put_off():
            made.append(make())
    except BaseException:
        for one in made:
            end(one)
        raise
    return made[0]
