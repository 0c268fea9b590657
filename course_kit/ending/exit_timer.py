"""A process ends in time, with the exit status it should have, although a native call holds the interpreter.

When a participant ends, Fast DDS can wait for ever (CONTRIBUTING.md says why), and rclpy keeps Python's lock meanwhile:
no signal handler and no other thread of Python's runs. So the C library keeps the time, and ends the process.
"""

from __future__ import annotations

import ctypes
import os
import time
from ctypes import byref, c_char, c_int, c_long, c_void_p
from typing import Any

from course_kit.ending import shared_memory

SIGEV_THREAD = 2  # of <signal.h>: when its time has come, the timer calls a function in a thread of its own


class _Value(ctypes.Union):  # union sigval
    _fields_ = (("number", c_int), ("pointer", c_void_p))


class _Event(ctypes.Structure):  # struct sigevent
    _fields_ = (("value", _Value), ("signal", c_int), ("notify", c_int), ("function", c_void_p), ("_", c_char * 40))


class _Setting(ctypes.Structure):  # struct itimerspec
    _fields_ = (("interval_s", c_long), ("interval_ns", c_long), ("value_s", c_long), ("value_ns", c_long))


class ExitTimer:
    """Ends this process with exit status `status` in `seconds` seconds, unless cancel() comes first.

    What Python has buffered is not written then: flush first. Its shared memory goes a moment before.
    """

    def __init__(self, seconds: float, status: int) -> None:
        self._libc = ctypes.CDLL(None)
        self._libc.strdup.restype = c_void_p  # what Python has in memory may be gone when the time has come
        paths = [self._libc.strdup(os.fsencode(path)) for path in shared_memory.made_by(os.getpid())]
        self._timers = [self._after(0.9 * seconds, self._libc.unlink, _Value(pointer=path)) for path in paths]
        self._timers.append(self._after(seconds, self._libc._exit, _Value(number=status)))

    def _after(self, seconds: float, function: Any, value: _Value) -> c_void_p:
        timer = c_void_p()
        event = _Event(value=value, notify=SIGEV_THREAD, function=ctypes.cast(function, c_void_p))
        self._libc.timer_create(time.CLOCK_MONOTONIC, byref(event), byref(timer))
        setting = _Setting(value_s=int(seconds), value_ns=int(seconds % 1 * 1e9))
        self._libc.timer_settime(timer, 0, byref(setting), None)
        return timer

    def cancel(self) -> None:
        """Let the process live."""
        for timer in self._timers:
            self._libc.timer_delete(timer)
