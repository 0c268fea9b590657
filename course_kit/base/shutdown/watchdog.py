"""Keeps this process from hanging while a native call holds Python's lock: starts the thread of watchdog.c.

The thread heals what dead processes have left in shared memory, for which others would wait without an end. It ends
this process in time, with its exit status, although no signal handler of Python's can run.
"""

from __future__ import annotations

import ctypes
import functools
import os
import signal
import sys
from typing import NoReturn

from course_kit.base.shutdown.signals import asking_to_end

LIBRARY = os.path.join(sys.prefix, "lib", "course_kit", "watchdog.so")  # set-up compiles it
HIDDEN = "COURSE_KIT_HIDDEN_PROCESSES"  # set in a sandbox that shows some of those only that share its shared memory
END_TIMEOUT = 3.0  # seconds from a signal to the end of a program

_is_program = False  # whether signals end this process, or did so until it heeded none


@functools.cache
def _library() -> ctypes.CDLL:
    """The compiled watchdog. OSError if set-up has not compiled it."""
    library = ctypes.CDLL(LIBRARY, use_errno=True)
    library.watchdog_end_in.argtypes = (ctypes.c_double, ctypes.c_int)
    library.watchdog_end_after_signals.argtypes = (ctypes.c_ulong, ctypes.c_double)
    if os.environ.get(HIDDEN):
        library.watchdog_expect_hidden()
    return library


def begin() -> int:
    """Heal shared memory now, and watch from now on; return the file descriptor that takes numbers of signals."""
    heal()
    descriptor = int(_library().watchdog_begin())
    if descriptor < 0:
        error = ctypes.get_errno()
        raise OSError(error, f"the watchdog of this process cannot start: {os.strerror(error)}")
    return descriptor


def heal() -> int:
    """Heal the dead segments of this user, ports and data; return how many there were.

    Those who wait on one get an error, and make it anew. One that may still be made is left alone.
    """
    return int(_library().watchdog_heal())


def end_after_signals(seconds: float = END_TIMEOUT, again: bool = False) -> None:
    """Have Ctrl-C, SIGTERM and SIGHUP end this process `seconds` later, if it has not ended by itself.

    The exit status is then 128 + the number of the signal, or that of end_in(). The signals need a handler of Python's.
    `again`: only if signals have ended this process before, as in a program, and not in a kernel.
    """
    global _is_program
    if again and not _is_program:
        return
    _is_program = True
    own = begin()
    before = signal.set_wakeup_fd(own, warn_on_full_buffer=False)
    if before != own:  # asyncio's, if it has handlers of its own: it gets the signals from the watchdog
        _library().watchdog_hand_on(before)
    numbers = sum(1 << number for number in (signal.SIGINT, *asking_to_end()))
    _library().watchdog_end_after_signals(numbers, seconds)


def heed_no_signals() -> None:
    """Have signals end this process no longer: it has something to write, or waits for a child that ends in time."""
    _library().watchdog_end_after_signals(0, 0.0)
    let_live()


def end_in(seconds: float, status: int) -> None:
    """End this process with exit status `status` in `seconds` seconds, sooner where a signal has set an earlier end.

    Python's buffers are not written then: flush first. The process's shared memory goes with it.
    """
    begin()
    _library().watchdog_end_in(seconds, status)


def end_now(status: int) -> NoReturn:
    """End this process with exit status `status`, and its shared memory, also that of half-made nodes."""
    _library().watchdog_end_now(status)
    raise AssertionError("a process has outlived its end")


def let_live() -> None:
    """Let this process live, whatever was to end it."""
    _library().watchdog_let_live()
