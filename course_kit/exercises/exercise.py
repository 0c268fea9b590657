"""An exercise as the catalogue has it: name, points, and how to know that it was begun."""

from __future__ import annotations

import re
from dataclasses import KW_ONLY, dataclass

LEVELS = ("warm-up", "medium", "harder", "project")


@dataclass
class Exercise:
    """One exercise."""

    name: str  # such as "topics-1"
    title: str
    _: KW_ONLY
    points: int
    level: str
    timeout: float = 15.0  # seconds that a check takes at most
    node_class: str | None = None  # the class that the student writes, if it asks for one
    function: str | None = None  # the function that the student writes, if it asks for one
    # The full name of the student's node, by which one also knows that it was begun; "" if it is no sign of that.
    node: str | None = None  # unless given, /face_west for a class FaceWest
    file: str | None = None  # a file below ros2_ws/src that the student writes, if it asks for one
    types: tuple[str, ...] = ()  # packages of types that the checker compiles for itself, once
    value: bool = False  # True where the answer is a value, which is handed to check() and to the function

    def __post_init__(self) -> None:
        if self.level not in LEVELS:
            raise ValueError(f"{self.name}: there is no level {self.level!r}, only {', '.join(LEVELS)}")
        if not (self.node_class or self.function or self.node or self.file or self.value):
            raise ValueError(
                f"{self.name}: say by `node_class`, `function`, `node`, `file` or `value` how to know that it was begun"
            )
        if self.node is None and self.node_class:
            self.node = f"/{re.sub('(?<=[a-z])(?=[A-Z])', '_', self.node_class).lower()}"

    @property
    def chapter(self) -> str:
        """The key in CHAPTERS, such as `topics` of `topics-1`."""
        return self.name.rsplit("-", 1)[0]
