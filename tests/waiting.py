"""Waiting in tests: for a condition, never for time."""

from __future__ import annotations

import inspect
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from course_kit.base import polling

TIMEOUT = 20.0  # seconds; discovery on a busy machine has a long tail
PAUSE = 0.01


def wait_until(
    condition: Callable[[], Any],
    what: str = "",
    timeout: float = TIMEOUT,
    pause: Callable[[float], object] = time.sleep,
) -> Any:
    """Wait for a condition to become true and return its value; else fail and name `what`, or the condition's code."""
    value = polling.wait_until(condition, timeout, PAUSE, pause)
    assert value, f"waited {timeout:g} s in vain for {what or _code(condition)}"
    return value


@contextmanager
def interrupted_when(condition: Callable[[], Any]) -> Iterator[None]:
    """Interrupt the block, as Ctrl-C does, once a condition is true; the block must raise KeyboardInterrupt."""
    is_over = threading.Event()

    def interrupt() -> None:
        if wait_until(lambda: is_over.is_set() or condition()) and not is_over.is_set():
            signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)

    waiting = threading.Thread(target=interrupt)
    waiting.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            yield
    finally:  # a block that ended by itself is not interrupted any more, nor is a later test
        is_over.set()
        waiting.join()


def _code(condition: Callable[[], Any]) -> str:
    try:
        return inspect.getsource(condition).strip()
    except (OSError, TypeError):  # built in, or typed in
        return repr(condition)
