"""Servers of services and actions, as those who call them wait for them."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any

from course_kit.cli.ros2.session import Session
from course_kit.cli.ros2.verbs import CommandError, did_you_mean

ANSWER_TIMEOUT = 30.0  # seconds in a notebook, for what is answered at once; a terminal waits as long as the real ros2
GONE = 2.0  # seconds after which a server that is not there any more will not answer
POLL = 0.002


def wait_for_server(
    session: Session, noun: str, name: str, wanted: str, is_ready: Callable[[], bool], count: Callable[[str], int]
) -> None:
    """Wait until the server is there; say after a while which of those that `count` knows of may be meant."""
    if session.until(is_ready, GONE, POLL):
        return
    there = {found: types for found, types in session.named(noun).items() if count(found)}
    types = [found for found in there.get(name, []) if found != wanted]
    suggestion = f"Did you mean {types[0]}?" if types else did_you_mean(name, there)
    if suggestion and not is_ready():
        session.warn(suggestion)
    session.until(is_ready)


def outcome(
    session: Session,
    future: Any,
    is_ready: Callable[[], bool],
    doing: str,
    lost: str,
    stops: Callable[[], bool] = lambda: False,
    timeout: float = math.inf,
) -> Any:
    """What a future brings; None if it `stops()` before.

    CommandError if its server has gone before (`lost`), or if nothing comes within `timeout` seconds in a notebook.
    """
    began = seen = time.monotonic()
    if not session.in_notebook:
        timeout = math.inf

    def is_over() -> bool:
        nonlocal seen
        if is_ready():
            seen = time.monotonic()
        return bool(future.done()) or time.monotonic() - seen > GONE or seen - began > timeout

    session.until(lambda: is_over() or stops(), poll=POLL)
    if stops() and not future.done():
        return None
    if not future.done():
        late = f"no answer within {timeout:g} s. Is the server busy in a callback, or not spun? Or the answer was lost"
        raise CommandError(f"Exception while {doing}: {late if seen - began > timeout else lost}")
    if future.exception() is not None:
        raise CommandError(f"Exception while {doing}: {future.exception()!r}")
    return future.result()
