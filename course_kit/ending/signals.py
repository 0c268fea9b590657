"""Which signals ask a program to end in good order, and how they wait until that can be."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Iterator


def asking_to_end() -> list[signal.Signals]:
    """SIGTERM, and SIGHUP, which comes from a terminal that closes, unless `nohup` has it ignored."""
    hears_terminal = signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN
    return [signal.SIGTERM, *([signal.SIGHUP] if hears_terminal else [])]


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
