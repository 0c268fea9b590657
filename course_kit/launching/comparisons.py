"""Substitutions that are 'true' or 'false'."""

from __future__ import annotations

from typing import Any

from course_kit.launching.context import LaunchContext
from course_kit.launching.substitutions import Composed, SomeSubstitutions, as_bool, as_text


class NotSubstitution(Composed):
    """The opposite of a truth."""

    shown = "{type}({value})"

    def __init__(self, value: SomeSubstitutions) -> None:
        super().__init__(value=value)

    def _text(self, context: LaunchContext, value: str) -> str:
        return str(not as_bool(value)).lower()


class _Comparison(Composed):
    shown = "{type}({left} {right})"

    def __init__(self, left: Any, right: Any) -> None:
        super().__init__(left=as_text(left), right=as_text(right))

    def _text(self, context: LaunchContext, left: str, right: str) -> str:
        return str(self._holds(left, right)).lower()

    def _holds(self, left: str, right: str) -> bool:
        raise NotImplementedError


class AndSubstitution(_Comparison):
    """'true' if both sides are."""

    def _holds(self, left: str, right: str) -> bool:
        return as_bool(left) and as_bool(right)


class OrSubstitution(_Comparison):
    """'true' if one of the sides is."""

    def _holds(self, left: str, right: str) -> bool:
        return as_bool(left) or as_bool(right)


class EqualsSubstitution(_Comparison):
    """'true' if both sides are equal; 'True' equals 'true' and '1'."""

    def _holds(self, left: str, right: str) -> bool:
        words = ({"true": "1", "false": "0"}.get(side.strip().lower(), side) for side in (left, right))
        return next(words) == next(words)


class NotEqualsSubstitution(EqualsSubstitution):
    """'true' if the sides differ."""

    def _holds(self, left: str, right: str) -> bool:
        return not super()._holds(left, right)
