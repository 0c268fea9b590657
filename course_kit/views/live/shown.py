"""A MIME bundle under the cell that runs, which can be shown anew: the one form in which every view stands there.

It always has a text, and a picture or a page where there is one: what a saved notebook, nbval, exported HTML and code
hosts show. While it is live, it may have a widget, which JupyterLab shows in its place.
"""

from __future__ import annotations

import contextlib
import uuid
from typing import Any

from IPython.display import DisplayHandle, display

from course_kit.views.live import tabs
from course_kit.views.live.described import PNG

Bundle = dict[str, Any]  # by MIME type
VIEW = "application/vnd.course-kit.view+json"  # the course's JupyterLab extension shows what has it
WIDGET = "application/vnd.jupyter.widget-view+json"


class Shown:
    """Something of a kind, such as "rates", under the cell that runs."""

    def __init__(self, kind: str, bundle: Bundle, widget: Any = None) -> None:
        self._kind, self._widget = kind, widget
        self._id = uuid.uuid4().hex
        self._handle: DisplayHandle | None
        tabs.begins(self._id)
        self._handle = display(
            self._data(bundle), raw=True, display_id=self._id, metadata=self._metadata(bundle, is_live=True)
        )

    def update(self, bundle: Bundle) -> None:
        """Show another one in its place; where there is a widget, the bundle is kept behind it."""
        self._put(bundle, is_live=True)

    def end(self, bundle: Bundle) -> None:
        """Show the last one, which stays; the widget ends."""
        tabs.ends(self._id)
        widget, self._widget = self._widget, None
        self._put(bundle, is_live=False)
        if widget is not None:
            _close(widget)

    def _put(self, bundle: Bundle, is_live: bool) -> None:
        if self._handle is not None:  # else there is no notebook
            self._handle.update(self._data(bundle), raw=True, metadata=self._metadata(bundle, is_live))

    def _data(self, bundle: Bundle) -> Bundle:
        data = {key: value for key, value in bundle.items() if key != "metadata"} | {VIEW: {"view": self._kind}}
        if self._widget is not None:
            data[WIDGET] = {"model_id": self._widget.model_id, "version_major": 2, "version_minor": 0}
        return data

    def _metadata(self, bundle: Bundle, is_live: bool) -> dict[str, Any]:
        """What differs from one run to the next: nbval does not compare it."""
        metadata = dict(bundle.get("metadata", {}))
        if PNG in bundle:
            metadata[PNG] = {**metadata.get(PNG, {}), "alt": bundle["text/plain"]}
        return {**metadata, "course_kit": {"id": self._id, "live": is_live}}


def _close(widget: Any) -> None:
    """End a widget with all that belongs to it, layouts and styles too: each has a comm."""
    for child in getattr(widget, "children", ()):
        _close(child)
    for name in ("layout", "style"):
        with contextlib.suppress(AttributeError):
            getattr(widget, name).close()
    widget.close()
