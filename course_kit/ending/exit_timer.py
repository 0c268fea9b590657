"""A process ends in time, with the exit status it should have, although a native call holds the interpreter.

When a participant ends, Fast DDS can wait for ever (CONTRIBUTING.md says why), and rclpy keeps Python's lock meanwhile:
no signal handler and no other thread of Python's runs. So the C library keeps the time, and ends the process.
"""

from __future__ import annotations

import ctypes
import time
from ctypes import byref, c_char, c_int, c_long, c_void_p

SIGEV_THREAD = 2  # of <signal.h>: when its time has come, the timer calls a function in a thread of its own


class _Event(ctypes.Structure):  # struct sigevent
    _fields_ = (("value", c_void_p), ("signal", c_int), ("notify", c_int), ("function", c_void_p), ("_", c_char * 40))


class _Setting(ctypes.Structure):  # struct itimerspec
    _fields_ = (("interval_s", c_long), ("interval_ns", c_long), ("value_s", c_long), ("value_ns", c_long))


class ExitTimer:
    """Ends this process with exit status `status` in `seconds` seconds, unless cancel() comes first.

    What Python has buffered is not written then: flush first.
    """

    def __init__(self, seconds: float, status: int) -> None:
        self._libc = ctypes.CDLL(None)
        self._timer = c_void_p()
        event = _Event(value=status, notify=SIGEV_THREAD, function=ctypes.cast(self._libc._exit, c_void_p))
        self._libc.timer_create(time.CLOCK_MONOTONIC, byref(event), byref(self._timer))
        setting = _Setting(value_s=int(seconds), value_ns=int(seconds % 1 * 1e9))
        self._libc.timer_settime(self._timer, 0, byref(setting), None)

    def cancel(self) -> None:
        """Let the process live."""
        self._libc.timer_delete(self._timer)
