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

from course_kit import polling

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

    def interrupt() -> None:
        wait_until(condition)
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)

    threading.Thread(target=interrupt).start()
    with pytest.raises(KeyboardInterrupt):
        yield


def _code(condition: Callable[[], Any]) -> str:
    try:
        return inspect.getsource(condition).strip()
    except (OSError, TypeError):  # built in, or typed in
        return repr(condition)
