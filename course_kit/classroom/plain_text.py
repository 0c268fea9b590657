"""Text of a student's programs, made fit for a page, a file or a terminal. Pure: no ROS."""

from __future__ import annotations

import re

from course_kit.base.programs.process_output import as_seen

# Controls, marks that turn the direction of text, halves of characters.
_CONTROLS = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")


def plain(text: str) -> str:
    """Return a text as a terminal would leave it: without colours, and without characters that are no text."""
    return "\n".join(_CONTROLS.sub("", as_seen(line)) for line in text.split("\n"))
