"""The check of debugging-1: which topics keep messages, and which lose some."""

from __future__ import annotations

from typing import Any

from course_kit.base.arguments import shown
from course_kit.exercises.checker.assertions import expect, parts
from course_kit.exercises.checker.checks import check_of

# What every action keeps is hidden, and true as well.
KEPT = ("/speed_limit", "/turtle1/rotate_absolute/_action/status")
LOSSY = ("/scan",)


@check_of("debugging-1")
def who_keeps(value: Any) -> None:
    """The topic that is kept for latecomers, and the one that may lose messages."""
    kept, lossy = parts(value, 2)
    for text, given, right, policy in (
        ("the topic that is kept for those who come later", kept, KEPT, "Durability TRANSIENT_LOCAL"),
        ("the topic that may lose messages", lossy, LOSSY, "Reliability BEST_EFFORT"),
    ):
        hint = f"You gave {shown(given)}. Its publisher has {policy}: `%ros2 topic info -v` of each topic shows it."
        expect(text, _absolute(given) in right, hint)


def _absolute(name: Any) -> str:
    """The full name of a topic, also if it is the only one of a list or a set; "" for what is no name."""
    if isinstance(name, list) and len(name) == 1:
        name = name[0]
    return f"/{name.strip().strip('/')}" if isinstance(name, str) else ""
