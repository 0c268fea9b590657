"""A view under a cell: it follows what it shows, until it is stopped or its cell is run again; a still of it stays."""

from __future__ import annotations

import html
import time
from collections.abc import Callable, Sequence
from typing import Any

from course_kit.base import html_tables, kernel
from course_kit.base.text import stands_still, table
from course_kit.views.live.life import Life, stop_all
from course_kit.views.live.shown import Bundle, Shown

LONGEST = 600.0  # seconds after which a view that was forgotten ends
STILL = 5.0  # seconds between two stills behind a widget


class View(Life):
    """Something live under the cell that made it. .stop() ends it; the last still stays.

    A kind of view with a widget keeps that up to date in `_show()`; others show their still anew there.
    """

    kind = "view"

    def _open(self, period: float, seconds: float = LONGEST, widget: Any = None) -> None:
        """Show it, in the place of the one of an earlier run of the cell, and begin to live."""
        self._deadline = time.monotonic() + seconds
        self._replace()
        self._kept, self._kept_at = self.still(), time.monotonic()
        self._shown = Shown(self.kind, self._kept, widget)
        self._begin(f"live {self.kind}", period)

    def still(self) -> Bundle:
        """What it shows now, as a text ("text/plain") with a picture or a page."""
        raise NotImplementedError

    def _keep(self, period: float = STILL) -> None:
        """Show the present still, unless that was `period` seconds ago or nothing is new."""
        if time.monotonic() - self._kept_at < period:
            return
        self._kept_at = time.monotonic()
        if (now := self.still()) != self._kept:
            self._kept = now
            self._shown.update(now)

    def _close(self) -> None:
        """Close what it has used."""

    def _replace(self) -> None:
        """End the one of an earlier run of the cell."""
        self._cell, self._request = kernel.cell()
        stop_all(self._replaces)

    def _replaces(self, other: Life) -> bool:
        """Return True if another is the same, from an earlier run of the cell."""
        if not isinstance(other, View) or other._request == self._request:
            return False
        return (other.kind, other._cell) == (self.kind, self._cell)

    def __repr__(self) -> str:
        return f"<{self.kind}, {'live' if self.is_running else 'stopped'}>"

    def _ipython_display_(self) -> None:
        """A cell that ends in a view has shown it already."""

    def _end(self, error: Exception | None) -> None:
        last = self._kept
        try:
            if error is None:
                last = self.still()
        except Exception as failed:
            error = failed
        if error is not None:
            last = as_text(stands_still(f"The view of {self.kind}", error))
        self._shown.end(last)
        self._close()


class LiveView(View):
    """Shows what `draw()` returns, a MIME bundle, every `period` seconds."""

    def __init__(
        self, kind: str, draw: Callable[[], Bundle], close: Callable[[], object], period: float, seconds: float
    ) -> None:
        """`close` is called at the end."""
        self.kind = kind
        self._draw, self._close = draw, close  # type: ignore[method-assign, assignment]
        self._period = period
        self._open(period, seconds)

    def still(self) -> Bundle:
        """What it shows now."""
        return self._draw()

    def _show(self) -> float:
        start = time.monotonic()
        self._keep(0.0)
        return max(self._period + start - time.monotonic(), self._period / 4)


def as_text(text: str) -> Bundle:
    """Words as plain text and as HTML in the notebook's own colours."""
    return as_tables([text])


def as_tables(parts: Sequence[str | Sequence[Sequence[str]]], left: int = 1) -> Bundle:
    """Words, and tables as rows of cells, below one another; the first `left` columns stand to the left."""
    css = "margin:0;white-space:pre-wrap"
    pages = [
        f"<pre style='{css}'>{html.escape(part)}</pre>" if isinstance(part, str) else html_tables.of_rows(part, left)
        for part in parts
    ]
    return {
        "text/plain": "\n\n".join(part if isinstance(part, str) else table(part, left) for part in parts),
        "text/html": f"<div class='course-kit-live'>{'<br>'.join(pages)}</div>",
    }
