"""Errors that name what only the real `ros2 launch` does."""

from __future__ import annotations

import difflib
import importlib
from collections.abc import Callable, Iterable
from typing import Any

REAL = "the real `ros2 launch` (apt's ros-jazzy-ros-base)"


class NotCoveredError(ImportError):
    """A launch file uses something that needs the real `ros2 launch`."""


def not_covered(what: str, near: Iterable[str] = ()) -> NotCoveredError:
    """The error for `what`; `near` are known names that may have been meant."""
    hint = "".join(f" (or did you mean {name}?)" for name in list(near)[:1])
    return NotCoveredError(f"{what} is not covered here: it needs {REAL}{hint}")


def attributes_of(module: str, known: Iterable[str]) -> Callable[[str], Any]:
    """A module's __getattr__: gives its submodules and refuses other names with an error that says what they need."""

    def get(name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(f"module {module!r} has no attribute {name!r}")
        try:
            return importlib.import_module(f"{module}.{name}")
        except ModuleNotFoundError as error:
            if error.name != f"{module}.{name}" and error.name != module:
                raise
        raise not_covered(f"{module}.{name}", difflib.get_close_matches(name, list(known), n=1, cutoff=0.8)) from None

    return get
