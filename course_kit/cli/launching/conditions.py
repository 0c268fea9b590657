"""Truths: conditions of actions, that is whether they are done, and substitutions that are 'true' or 'false'."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from course_kit.cli.launching.context import LaunchContext
from course_kit.cli.launching.substitutions import (
    Composed,
    SomeSubstitutions,
    as_bool,
    as_text,
    described,
    normalize,
    perform,
)


class InvalidConditionExpressionError(RuntimeError):
    """A condition is neither true nor false."""


class Condition:
    """Something that holds or not when the launch file runs: what `predicate` says, called with the context."""

    def __init__(self, *, predicate: Callable[[LaunchContext], bool]) -> None:
        self._predicate = predicate

    def evaluate(self, context: LaunchContext) -> bool:
        """Return True if it holds."""
        return bool(self._predicate(context))


class IfCondition(Condition):
    """Holds if the text is 'true' or '1', does not if it is 'false' or '0', in any case of letters."""

    def __init__(self, predicate_expression: SomeSubstitutions) -> None:
        self._expression = normalize(predicate_expression)
        super().__init__(predicate=self._is_true)

    def _is_true(self, context: LaunchContext) -> bool:
        text = perform(context, self._expression)
        try:
            return as_bool(text)
        except ValueError:
            raise InvalidConditionExpressionError(
                f"a condition is true, 1, false or 0, and not '{text}', as it comes of '{described(self._expression)}'"
            ) from None


class UnlessCondition(IfCondition):
    """The opposite of IfCondition."""

    def _is_true(self, context: LaunchContext) -> bool:
        return not super()._is_true(context)


class LaunchConfigurationEquals(Condition):
    """Holds if a launch configuration has a value."""

    def __init__(self, launch_configuration_name: str, expected_value: SomeSubstitutions | None) -> None:
        self._name = launch_configuration_name
        self._expected = None if expected_value is None else normalize(expected_value)
        super().__init__(predicate=self._is_equal)

    def _is_equal(self, context: LaunchContext) -> bool:
        value = context.launch_configurations.get(self._name)
        return bool(value == (None if self._expected is None else perform(context, self._expected)))


class LaunchConfigurationNotEquals(LaunchConfigurationEquals):
    """The opposite of LaunchConfigurationEquals."""

    def _is_equal(self, context: LaunchContext) -> bool:
        return not super()._is_equal(context)


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


class _Many(Composed):
    _combine = staticmethod(all)

    def __init__(self, *truths: SomeSubstitutions) -> None:
        self.truths = [normalize(truth) for truth in truths]
        super().__init__()

    def describe(self) -> str:
        """The truths."""
        return f"{type(self).__name__}({described(self.truths, ' ')})"

    def _text(self, context: LaunchContext) -> str:
        return str(self._combine([as_bool(perform(context, truth)) for truth in self.truths])).lower()


class AllSubstitution(_Many):
    """'true' if all are."""


class AnySubstitution(_Many):
    """'true' if one of them is."""

    _combine = staticmethod(any)


class IfElseSubstitution(Composed):
    """One text or another."""

    def __init__(
        self, condition: SomeSubstitutions, if_value: SomeSubstitutions = "", else_value: SomeSubstitutions = ""
    ) -> None:
        super().__init__(condition=condition)
        self.if_value, self.else_value = normalize(if_value), normalize(else_value)

    def describe(self) -> str:
        """The condition and both texts."""
        texts = ", ".join(map(described, (self._texts["condition"], self.if_value, self.else_value)))
        return f"IfElseSubstitution({texts})"

    def _text(self, context: LaunchContext, condition: str) -> str:
        return perform(context, self.if_value if as_bool(condition) else self.else_value)
