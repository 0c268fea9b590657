"""The one life of all that moves under a cell: a thread that shows anew what there is, until it ends."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable

from course_kit.ros.spinning import context
from course_kit.views.live import tabs

END_TIMEOUT = 4.0  # seconds for a last picture that is just being drawn
UNSEEN = 0.25  # seconds between two looks at whether somebody looks again

alive: list[Life] = []  # the oldest first


class Life:
    """A thread that shows anew what there is, until stop(), an error, or the end of ROS; what was shown last stays."""

    _thread: threading.Thread | None = None
    _deadline = math.inf  # on the clock of time.monotonic(): when it ends by itself

    def _begin(self, name: str, rest: float) -> None:
        """Begin to live; `rest` seconds until the first look."""
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._live, args=(rest,), name=name, daemon=True)
        alive.append(self)
        context.before_stop(stop_all)
        self._thread.start()

    def _show(self) -> float:
        """Show what is new; the seconds until the next look."""
        raise NotImplementedError

    def _unseen(self) -> float:
        """Do what must be done also while nobody looks; the seconds until the next look."""
        return UNSEEN

    def _end(self, error: Exception | None) -> None:
        """Close what was used, and say that it has ended, and why."""
        raise NotImplementedError

    @property
    def is_running(self) -> bool:
        """True if it is still shown anew."""
        return self._thread is not None and self._thread.is_alive()

    def stop(self) -> None:
        """End it; what was shown last stays. Safe to call twice."""
        if self._thread is None:  # it has not begun
            return
        self._ending.set()
        if threading.current_thread() is not self._thread:
            self._thread.join(END_TIMEOUT)

    close = stop

    def _live(self, rest: float) -> None:
        why = None
        try:
            while not self._ending.wait(rest) and time.monotonic() < self._deadline:
                rest = self._show() if tabs.somebody_looks() else self._unseen()
        except Exception as error:  # there is no other place where it could be seen; ROS was shut down, for instance
            why = error
        try:
            self._end(why)
        finally:
            alive.remove(self)


def stop_all(which: Callable[[Life], bool] = lambda _: True) -> None:
    """End all that live, before ROS ends; or some of them, before another takes their place."""
    for one in [each for each in alive if which(each)]:
        one.stop()
