"""Definitions of messages, services and actions as text, with what their fields are made of below each field.

The real command hands each line alone to rosidl's parser, cuts comments where they are not wanted, and prints the
rest as it stands in the file. What it leaves of a comment (a line that has nothing but `#`, the `#` before a comment
that is cut) is left here too, so that the two print the same.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from rosidl_adapter.parser import parse_message_string  # type: ignore[import-untyped]

from course_kit.ros.interface_types import nested_types

SEPARATOR = "---"
KINDS = ("msg", "srv", "action")


def show(
    type_name: str, read: Callable[[str], str], comments: bool = True, nested_comments: bool = False, depth: int = 0
) -> Iterator[str]:
    """The lines of a definition; `read(type name)` gives the text of one, and its errors pass through."""
    package = type_name.split("/")[0]
    for line in read(type_name).splitlines():
        text = line.rstrip()
        parsed = parse_message_string(package, "Line", "" if text == SEPARATOR else text)
        shown = text if comments else without_comment(text, parsed)
        if shown is not None:
            yield "\t" * depth + shown if shown else ""
        for nested in nested_types(parsed):
            yield from show(nested, read, nested_comments, nested_comments, depth + 1)


def without_comment(text: str, parsed: Any) -> str | None:
    """What the real command leaves of a line without its comment; None for a line that is not shown at all."""
    if not text or parsed.annotations["comment"]:
        return None
    comments = [comment for part in [*parsed.fields, *parsed.constants] for comment in part.annotations["comment"]]
    return text[: text.find(comments[0]) - 1].strip() if comments else text
