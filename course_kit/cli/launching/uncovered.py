"""Errors that name what only the real `ros2 launch` does."""

from __future__ import annotations

from collections.abc import Iterable

REAL = "the real `ros2 launch` (apt's ros-jazzy-ros-base)"


class NotCoveredError(ImportError):
    """A launch file uses something that needs the real `ros2 launch`."""


def not_covered(what: str, near: Iterable[str] = ()) -> NotCoveredError:
    """The error for `what`; `near` are known names that may have been meant."""
    hint = "".join(f" (or did you mean {name}?)" for name in list(near)[:1])
    return NotCoveredError(f"{what} is not covered here: it needs {REAL}{hint}")
