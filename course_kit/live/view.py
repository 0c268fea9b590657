"""Something under a cell that is drawn anew every so often, until it is stopped or its cell is run again."""

from __future__ import annotations

import base64
import html
import io
import time
from collections.abc import Callable

from course_kit import kernel
from course_kit.figures import SCREEN_DPI, Plot
from course_kit.live.life import Bundle, Life, Shown, stop_all
from course_kit.text import stands_still

LONGEST = 600.0  # seconds after which a view that was forgotten ends


class LiveView(Life):
    """Shows what `draw()` returns, a MIME bundle, every `period` seconds. .stop() ends it; the last picture stays."""

    def __init__(
        self, what: str, draw: Callable[[], Bundle], close: Callable[[], object], period: float, seconds: float
    ) -> None:
        """`what` names the kind of view; `close` is called at the end."""
        self.what = what
        self._draw, self._close = draw, close
        self._period = period
        self._deadline = time.monotonic() + seconds
        self._cell, self._request = kernel.cell()
        stop_all(self._replaces)
        self._shown = Shown(draw())
        self._begin(f"live {what}", period)

    def _replaces(self, other: Life) -> bool:
        """Whether another is the same, from an earlier run of the cell."""
        if not isinstance(other, LiveView) or other._request == self._request:
            return False
        return (other.what, other._cell) == (self.what, self._cell)

    def __repr__(self) -> str:
        return f"<{self.what}, {'live' if self.is_running else 'stopped'}>"

    def _ipython_display_(self) -> None:
        """A cell that ends in a view has shown it already."""

    def _show(self) -> float:
        start = time.monotonic()
        self._shown.update(self._draw())
        if start >= self._deadline:
            self._ending.set()
        return max(self._period + start - time.monotonic(), self._period / 4)

    def _end(self, error: Exception | None) -> None:
        try:
            if error is None:
                self._show()
        except Exception as last:
            error = last
        if error is not None:
            self._shown.update(as_text(stands_still(f"The view of {self.what}", error)))
        self._close()


def as_text(text: str) -> Bundle:
    """A table, or other aligned text, as plain text and as HTML in the notebook's own colours; lines do not wrap."""
    css = "margin:0;overflow-x:auto;white-space:pre"
    return {"text/plain": text, "text/html": f"<pre class='course-kit-live' style='{css}'>{html.escape(text)}</pre>"}


def as_picture(figure: Plot) -> Bundle:
    """A figure as a picture, drawn at the size at which it is shown: a sharper one takes three times as long."""
    picture = io.BytesIO()
    figure.savefig(picture, format="png", dpi=SCREEN_DPI)
    return {"image/png": base64.b64encode(picture.getvalue()).decode(), "text/plain": "(a live picture)"}
