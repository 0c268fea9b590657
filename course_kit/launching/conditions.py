"""Conditions of actions: whether they are done."""

from __future__ import annotations

from collections.abc import Callable

from course_kit.launching.context import LaunchContext
from course_kit.launching.substitutions import SomeSubstitutions, as_bool, described, normalize, perform


class InvalidConditionExpressionError(RuntimeError):
    """A condition is neither true nor false."""


class Condition:
    """Something that holds or not when the launch file runs: what `predicate` says, called with the context."""

    def __init__(self, *, predicate: Callable[[LaunchContext], bool]) -> None:
        self._predicate = predicate

    def evaluate(self, context: LaunchContext) -> bool:
        """Whether it holds."""
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
                f"invalid condition expression, expected one of 'true', '1', 'false', or '0', but got '{text}' from "
                f"'{described(self._expression)}'"
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
