"""What stands under a cell and changes, and the one life of all that moves there."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from IPython.display import DisplayHandle, display

from course_kit.spinning import context

Bundle = dict[str, Any]  # by MIME type
END_TIMEOUT = 4.0  # seconds for a last picture that is just being drawn

alive: list[Life] = []  # the oldest first


class Shown:
    """A MIME bundle under the cell that runs; it can be shown anew."""

    def __init__(self, bundle: Bundle) -> None:
        self._handle: DisplayHandle | None = display(bundle, raw=True, display_id=True)

    def update(self, bundle: Bundle) -> None:
        """Show another one in its place."""
        if self._handle is not None:  # else there is no notebook
            self._handle.update(bundle, raw=True)


class Life:
    """A thread that shows anew what there is, until stop(), an error, or the end of ROS; what was shown last stays."""

    _thread: threading.Thread | None = None

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

    def _end(self, error: Exception | None) -> None:
        """Close what was used, and say that it has ended, and why."""
        raise NotImplementedError

    @property
    def is_running(self) -> bool:
        """Whether it is still shown anew."""
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
            while not self._ending.wait(rest):
                rest = self._show()
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
