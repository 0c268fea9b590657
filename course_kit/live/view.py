"""Something under a cell that is drawn anew every so often, until it is stopped or its cell is run again."""

from __future__ import annotations

import base64
import html
import io
import threading
import time
from collections.abc import Callable
from typing import Any

from IPython.core.getipython import get_ipython
from IPython.display import DisplayHandle, display

from course_kit.figures import SCREEN_DPI, Plot
from course_kit.spinning import context

Bundle = dict[str, Any]
LONGEST = 600.0  # seconds after which a view that was forgotten ends

_views: list[LiveView] = []


class LiveView:
    """Shows what `draw()` returns, a MIME bundle, every `period` seconds. .stop() ends it; the last picture stays."""

    def __init__(
        self, what: str, draw: Callable[[], Bundle], close: Callable[[], object], period: float, seconds: float
    ) -> None:
        """`what` names the kind of view; `close` is called at the end."""
        self.what = what
        self._draw, self._close = draw, close
        self._period = period
        self._deadline = time.monotonic() + seconds
        self._ending = threading.Event()
        self._cell, self._request = _cell()
        for view in list(_views):
            if (view.what, view._cell) == (what, self._cell) and view._request != self._request:
                view.stop()
        _views.append(self)
        context.before_stop(stop_all)
        self._handle: DisplayHandle | None = display(draw(), raw=True, display_id=True)
        self._thread = threading.Thread(target=self._keep_drawing, name=f"live {what}", daemon=True)
        self._thread.start()

    @property
    def is_running(self) -> bool:
        """Whether the view is still updated."""
        return not self._ending.is_set()

    def stop(self) -> None:
        """End it; safe to call twice."""
        self._ending.set()
        if threading.current_thread() is not self._thread:
            self._thread.join(2.0)

    def __repr__(self) -> str:
        return f"<{self.what}, {'live' if self.is_running else 'stopped'}>"

    def _ipython_display_(self) -> None:
        """A cell that ends in a view has shown it already."""

    def _keep_drawing(self) -> None:
        due = time.monotonic() + self._period
        try:
            while not self._ending.wait(max(0.0, due - time.monotonic())) and due < self._deadline:
                self._show()
                due = max(due + self._period, time.monotonic() + self._period / 4)
            self._show()
        except Exception as error:  # ROS was shut down, for instance
            self._tell(error)
        finally:
            self._ending.set()
            self._close()
            if self in _views:
                _views.remove(self)

    def _show(self) -> None:
        if self._handle is not None:
            self._handle.update(self._draw(), raw=True)

    def _tell(self, error: Exception) -> None:
        if self._handle is not None:
            self._handle.update({"text/plain": f"{self.what} ended: {error}"}, raw=True)


def stop_all() -> None:
    """End every view, before ROS ends."""
    for view in list(_views):
        view.stop()


def _cell() -> tuple[str, str]:
    """What identifies the cell that runs now, also when it is run again, and this run of it; empty elsewhere."""
    shell: Any = get_ipython()
    request = shell.get_parent() if hasattr(shell, "get_parent") else {}
    return str(request.get("metadata", {}).get("cellId", "")), str(request.get("header", {}).get("msg_id", ""))


def as_text(text: str) -> Bundle:
    """A table, or other aligned text, as plain text and as HTML in the notebook's own colours; lines do not wrap."""
    css = "margin:0;overflow-x:auto;white-space:pre"
    return {
        "text/plain": text,
        "text/html": f"<pre class='course-kit-live' style='{css}'>{html.escape(text)}</pre>",
    }


def as_picture(figure: Plot) -> Bundle:
    """A figure as a picture, drawn at the size at which it is shown: a sharper one takes three times as long."""
    picture = io.BytesIO()
    figure.savefig(picture, format="png", dpi=SCREEN_DPI)
    return {"image/png": base64.b64encode(picture.getvalue()).decode(), "text/plain": "(a live picture)"}
