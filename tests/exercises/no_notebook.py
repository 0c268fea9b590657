"""A notebook that is not there, for tests of assertions that need none."""

from __future__ import annotations

from typing import Any

from course_kit.exercises.checker.notebook import Notebook


class NoNotebook(Notebook):
    """Nobody at the other end: each order is answered by nothing."""

    def __init__(self) -> None:
        pass

    def order(self, do: str, domain: int, timeout: float, **details: Any) -> dict[str, Any]:
        return {}
