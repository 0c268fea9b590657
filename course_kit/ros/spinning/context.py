"""The one ROS context of this process: started when something needs it, ended before Python does."""

from __future__ import annotations

import atexit
import contextlib
import os
import sys
import threading
from collections.abc import Callable, Iterator, Mapping

import rclpy
from rclpy.context import Context
from rclpy.signals import SignalHandlerOptions, uninstall_signal_handlers

from course_kit.base.shutdown import shared_memory, watchdog

# Callbacks run outside any cell, so nothing they log may go to a cell's output: logs travel over /rosout alone.
ARGUMENTS = ["--ros-args", "--disable-external-lib-logs", "--disable-stdout-logs"]

# What says which machines a context speaks with.
DOMAIN = "ROS_DOMAIN_ID"
RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
REACH = (RANGE, "ROS_LOCALHOST_ONLY", "ROS_STATIC_PEERS")

EXIT_TIMEOUT = 30.0  # seconds from the end of Python's work to that of its process, in which bags are closed

_lock = threading.RLock()
_ending = threading.RLock()  # not _lock: threads that end use ROS to the last, and ask for it by start()
_starts = 0
_owner = 0
_domain_given: int | None = None  # to rclpy.init(): else it is that of the environment
_closers: list[Callable[[], None]] = []
_plain_init = rclpy.init


def start(args: list[str] | None = None, domain_id: int | None = None) -> int:
    """Start ROS unless it runs already; return how many times this process has started it.

    `args` and `domain_id` are those of rclpy.init(). A context that rclpy.init() made is adopted; its signal
    handlers go, because in a kernel an interrupt is meant for the cell and not for ROS.
    """
    global _starts, _owner, _domain_given
    with _lock:
        if rclpy.ok():
            if _starts == 0:
                uninstall_signal_handlers()
                _starts = 1
        else:
            if _starts == 0:
                shared_memory.tidy()  # a process before this one may have been killed
            watchdog.begin()
            arguments = [*(args or []), *ARGUMENTS]
            _plain_init(args=arguments, domain_id=domain_id, signal_handler_options=SignalHandlerOptions.NO)
            _domain_given = domain_id
            _starts += 1
        if _owner != os.getpid():
            _owner = os.getpid()
            atexit.unregister(_stop_at_exit)
            atexit.register(_stop_at_exit)
        return _starts


def separate(domain: int | None, reach: str | None) -> Context:
    """A context beside that of this process, in a domain; None: that of the environment.

    `reach` is its ROS_AUTOMATIC_DISCOVERY_RANGE, whatever the environment says; None: as the environment says.
    """
    made = Context()
    watchdog.begin()
    with _lock, contextlib.nullcontext() if reach is None else _reaching(reach):
        _plain_init(args=ARGUMENTS, context=made, domain_id=domain, signal_handler_options=SignalHandlerOptions.NO)
    return made


@contextlib.contextmanager
def _reaching(reach: str) -> Iterator[None]:
    """Have contexts that are made inside reach so far.

    rclpy has no other way to say so than the variables that rcl reads. They change for rcl and not in os.environ, so
    no program that another thread starts meanwhile from there gets them; and not at all where they are so already.
    """
    wanted = {**dict.fromkeys(REACH), RANGE: reach}
    others = {name: value for name, value in wanted.items() if os.environ.get(name) != value}
    try:
        _put(others)
        yield
    finally:
        _put({name: os.environ.get(name) for name in others})


def _put(variables: Mapping[str, str | None]) -> None:
    for name, value in variables.items():
        if value is None:
            os.unsetenv(name)
        else:
            os.putenv(name, value)


def elsewhere() -> str:
    """That ROS runs in another domain than ROS_DOMAIN_ID says by now, and the cure, in a sentence; else ''."""
    wanted = os.environ.get(DOMAIN) or "0"
    if _starts == 0 or not rclpy.ok() or not wanted.isdigit():
        return ""
    domain = rclpy.get_default_context().get_domain_id()
    if domain == int(wanted) or domain == _domain_given:
        return ""
    return (
        f"{DOMAIN} is {wanted} by now, and the nodes of this notebook stay in domain {domain}, for ROS reads it once, "
        f"at its start: call rclpy.shutdown() and run your nodes again, or restart the kernel."
    )


def before_stop(closer: Callable[[], None]) -> None:
    """Have `closer` called before the context ends; the one registered last comes first."""
    with _lock:
        if closer not in _closers:
            _closers.append(closer)


def ended(closer: Callable[[], None]) -> None:
    """Have `closer` called no more before the context ends: what it closes has ended by itself."""
    with contextlib.suppress(ValueError):
        _closers.remove(closer)


def stop() -> None:
    """End every executor thread, then the context. Safe to call twice; a forked child leaves it alone."""
    with _ending:
        if _owner != os.getpid():
            return
        for closer in reversed([*_closers]):
            with contextlib.suppress(Exception):  # one part that cannot end must not keep the others
                closer()
        with _lock:
            rclpy.try_shutdown()


def _stop_at_exit() -> None:
    """Call stop(), and end a process that cannot leave the graph in time.

    Its exit status is 1 then if an exception has ended it, else 0: Python tells nobody what sys.exit() was given.
    """
    if _owner == os.getpid():
        watchdog.end_in(EXIT_TIMEOUT, status=int(hasattr(sys, "last_value")))
    stop()
