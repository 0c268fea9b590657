"""Substitutions that compare others: 'true' or 'false'."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from course_kit.launching.substitutions import SomeSubstitutions, Substitution, as_bool, described, normalize, perform

if TYPE_CHECKING:
    from course_kit.launching.context import LaunchContext

_LIKE_BOOL = {"true": "1", "false": "0"}  # so that 'True' equals 'true' and '1'


class _Comparison(Substitution):
    def __init__(self, left: Any, right: Any) -> None:
        self.sides = [
            normalize(side if isinstance(side, (str, Substitution, os.PathLike, list, tuple)) else str(side))
            for side in (left, right)
        ]

    def describe(self) -> str:
        return f"{type(self).__name__}({' '.join(described(side) for side in self.sides)})"

    def is_equal(self, context: LaunchContext) -> bool:
        left, right = (perform(context, side) for side in self.sides)
        words = [_LIKE_BOOL.get(side.strip().lower(), side) for side in (left, right)]
        return words[0] == words[1]


class EqualsSubstitution(_Comparison):
    """'true' if both sides are equal."""

    def perform(self, context: LaunchContext) -> str:
        return str(self.is_equal(context)).lower()


class NotEqualsSubstitution(_Comparison):
    """'true' if the sides differ."""

    def perform(self, context: LaunchContext) -> str:
        return str(not self.is_equal(context)).lower()


class NotSubstitution(Substitution):
    """The opposite of a truth."""

    def __init__(self, value: SomeSubstitutions) -> None:
        self.value = normalize(value)

    def describe(self) -> str:
        return f"NotSubstitution({described(self.value)})"

    def perform(self, context: LaunchContext) -> str:
        return str(not as_bool(perform(context, self.value))).lower()


class AndSubstitution(_Comparison):
    """'true' if both sides are."""

    def perform(self, context: LaunchContext) -> str:
        return str(all(as_bool(perform(context, side)) for side in self.sides)).lower()


class OrSubstitution(_Comparison):
    """'true' if one of the sides is."""

    def perform(self, context: LaunchContext) -> str:
        return str(any(as_bool(perform(context, side)) for side in self.sides)).lower()
