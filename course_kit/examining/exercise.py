"""An exercise, as its check declares it: name, points, minutes, and how to know that it was begun."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

LEVELS = ("warm-up", "medium", "harder", "project")


@dataclass(frozen=True)
class Exercise:
    """One exercise, and the function that checks it."""

    name: str  # such as "topics-1"
    title: str
    points: int
    minutes: int
    level: str
    timeout: float  # seconds that a check takes at most
    node_class: str | None  # the class that the student writes, if it asks for one
    node: str | None  # the full name of the student's node, by which one also knows that it was begun
    file: str | None  # a file below ros2_ws/src that the student writes, if it asks for one
    types: tuple[str, ...]  # packages of types that the checker compiles for itself, once
    watches: tuple[str, ...]  # topics of the student's domain that are listened to from the chapter's first check on
    value: bool  # whether the answer is a value, handed to check()
    check: Callable[..., None]

    @property
    def chapter(self) -> str:
        """The key in CHAPTERS, such as `topics` of `topics-1`."""
        return self.name.rsplit("-", 1)[0]


DECLARED: dict[str, Exercise] = {}  # by name, as far as the modules of their chapters are loaded


def exercise(
    name: str,
    title: str,
    *,
    points: int,
    minutes: int,
    level: str,
    timeout: float = 15.0,
    node_class: str | None = None,
    node: str | None = None,
    file: str | None = None,
    types: tuple[str, ...] = (),
    watches: tuple[str, ...] = (),
    value: bool = False,
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Declare the function below as the check of an exercise; with `value` it is given the student's value.

    `node` is the full name of the student's node: /face_west for a `node_class` FaceWest unless another one is given,
    "" if it is no sign that the exercise was begun.
    """
    if level not in LEVELS:
        raise ValueError(f"{name}: there is no level {level!r}, only {', '.join(LEVELS)}")
    if node is None and node_class:
        node = f"/{re.sub('(?<=[a-z])(?=[A-Z])', '_', node_class).lower()}"
    if not (node_class or node or file or value):
        raise ValueError(f"{name}: say by `node_class`, `node`, `file` or `value` how to know that it was begun")

    def declare(check: Callable[..., None]) -> Callable[..., None]:
        DECLARED[name] = Exercise(
            name, title, points, minutes, level, timeout, node_class, node, file, types, watches, value, check
        )
        return check

    return declare
