"""Long tasks and how far they are: a worker reports here, and a progress bar listens. Pure: no Jupyter.

A terminal has no listener, so nothing is shown there.
"""

from __future__ import annotations

import time
from contextlib import contextmanager

TYPE_CHECKING = False  # typing would cost every `ros2` some milliseconds of its start
if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

SECONDS = "s"
LONGEST = 100  # characters of what a task is


class LongTask:
    """One thing that may take long. Who works on it sets `done`, `total` and `doing` as they become known."""

    def __init__(self, what: str | Callable[[], str], total: float | None, unit: str, at_most: bool) -> None:
        self._what = what
        self.total = total
        self.unit = unit
        self.at_most = at_most  # whether it usually ends long before `total`
        self.done: float | Callable[[], float] | None = None  # of seconds, those since the beginning unless it is set
        self.doing = ""  # what of it is under way
        self.begun = time.monotonic()
        self.is_over = False

    @property
    def seconds(self) -> float:
        """How long it has taken so far."""
        return time.monotonic() - self.begun

    def begin_again(self, total: float) -> None:
        """Let it take at most `total` seconds from now on."""
        self.begun, self.total = time.monotonic(), total

    def state(self) -> dict[str, str | float | None]:
        """What it is, how far as a fraction (None where that is not known), and both in words."""
        what = self._what if isinstance(self._what, str) else self._what()
        what = what if len(what) <= LONGEST else f"{what[: LONGEST - 1]}…"
        seconds = self.seconds
        done = self.done() if callable(self.done) else self.done
        if done is None and self.unit == SECONDS:
            done = seconds
        known = self.total is not None and self.total > 0 and done is not None
        fraction = min(max(done / self.total, 0.0), 1.0) if known else None  # type: ignore[operator]
        parts = [self.doing] if self.doing else []
        if known:
            limit = f"{'at most ' if self.at_most else ''}{self.total:.0f} {self.unit}"
            parts.append(f"{done:.0f} of {limit}")
        if self.unit != SECONDS or not known:
            parts.append(f"{seconds:.0f} s")
        return {"what": what, "fraction": fraction, "text": f"{what}: {', '.join(parts)}"}


# What is called with a task as it begins and as it is over, in the thread that works on it.
listeners: set[Callable[[LongTask], None]] = set()


def _tell(task: LongTask) -> None:
    for listener in list(listeners):
        listener(task)


@contextmanager
def long_task(
    what: str | Callable[[], str], total: float | None = None, unit: str = SECONDS, at_most: bool = False
) -> Iterator[LongTask]:
    """Say that the block may take long, and how long if that is known: `total` seconds, packages, messages.

    `what` may be a function that says it, called only if it is to be shown, in another thread.
    """
    task = LongTask(what, total, unit, at_most)
    _tell(task)
    try:
        yield task
    finally:
        task.is_over = True
        _tell(task)
