"""Puts an alternative text beside each picture of a cell: as plain text, and as metadata of the picture.

A picture tells its text itself: a figure by what is drawn in it, an image by the `Description` of PNG in its `info`.
"""

from __future__ import annotations

import functools
from typing import Any

PNG = "image/png"


def attach(shell: Any) -> None:
    """Describe what is shown from now on, matplotlib's own figures too."""
    formatter = shell.display_formatter
    plain = formatter.format

    @functools.wraps(plain)
    def describe(shown: Any, *args: Any, **kwargs: Any) -> tuple[dict[str, Any], dict[str, Any]]:
        data, metadata = plain(shown, *args, **kwargs)
        if PNG in data and (text := description_of(shown)):
            data["text/plain"] = text
            metadata.setdefault(PNG, {})["alt"] = text
        return data, metadata

    formatter.format = describe


def description_of(shown: Any) -> str:
    """The alternative text of a picture; nothing if it has none."""
    # What shows itself as PNG is one of these. They are imported late: both take long at the start of a kernel.
    from matplotlib.figure import Figure
    from PIL import Image

    from course_kit.base import alternative_text, figures

    if isinstance(shown, figures.Plot):
        return repr(shown)
    if isinstance(shown, Figure):
        return alternative_text.of_figure(shown)
    return str(shown.info.get("Description", "")) if isinstance(shown, Image.Image) else ""
