"""Actions that set values, group others, log, and call functions of the launch file."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from course_kit.launching import output
from course_kit.launching.context import LaunchContext
from course_kit.launching.entities import Action, Entities, LaunchDescriptionEntity
from course_kit.launching.handlers import SomeEntities, as_list
from course_kit.launching.substitutions import SomeSubstitutions, Substitution, normalize, perform


class DeclareLaunchArgument(Action):
    """Declares an argument of the launch file, to be given as name:=value."""

    def __init__(
        self,
        name: str,
        *,
        default_value: Any = None,
        description: str | None = None,
        choices: Iterable[str] | None = None,
        **options: Any,
    ) -> None:
        super().__init__(**options)
        self.name = name
        self.default_value = None if default_value is None else normalize(default_value)
        self.choices = None if choices is None else list(choices)
        self.description = _description(description, self.choices)
        self._conditionally_included = False
        if self.choices is None:
            return
        if not self.choices:
            self._refuse("Provided choices arg is empty. Use None to ignore the choice list.")
        if isinstance(default_value, str) and default_value not in self.choices:
            self._refuse(f'Provided default_value "{default_value}" is not in provided choices "{self.choices}".')

    @staticmethod
    def _refuse(message: str) -> None:
        output.get_logger("launch.actions.declare_launch_argument").error(message)
        raise RuntimeError(message)

    def execute(self, context: LaunchContext) -> Entities:
        values = context.launch_configurations
        if self.name not in values:
            if self.default_value is None:
                output.get_logger("launch.actions.declare_launch_argument").error(
                    f'Required launch argument "{self.name}" (description: "{self.description}") was not provided'
                )
                raise RuntimeError(f'Required launch argument "{self.name}" was not provided.')
            values[self.name] = perform(context, self.default_value)
        if self.choices is not None and values[self.name] not in self.choices:
            self._refuse(
                f'Argument "{self.name}" provided value "{values[self.name]}" is not valid. '
                f"Valid options are: {self.choices}"
            )
        return None


def _description(given: str | None, choices: list[str] | None) -> str:
    if choices is None:
        return given if given is not None else "no description given"
    if given is None:
        return f"One of: {choices}"
    return f"{given}{'' if given.endswith('.') else '.'} Valid choices are: {choices}"


class SetLaunchConfiguration(Action):
    """Gives a launch configuration a value."""

    def __init__(self, name: SomeSubstitutions, value: SomeSubstitutions, **options: Any) -> None:
        super().__init__(**options)
        self.name = normalize(name)
        self.value = normalize(value)

    def execute(self, context: LaunchContext) -> Entities:
        context.launch_configurations[perform(context, self.name)] = perform(context, self.value)
        return None


class UnsetLaunchConfiguration(Action):
    """Takes a launch configuration away."""

    def __init__(self, name: SomeSubstitutions, **options: Any) -> None:
        super().__init__(**options)
        self.name = normalize(name)

    def execute(self, context: LaunchContext) -> Entities:
        context.launch_configurations.pop(perform(context, self.name), None)
        return None


class SetEnvironmentVariable(Action):
    """Sets an environment variable for the processes that are started after it."""

    def __init__(self, name: SomeSubstitutions, value: SomeSubstitutions, **options: Any) -> None:
        super().__init__(**options)
        self.name = normalize(name)
        self.value = normalize(value)

    def execute(self, context: LaunchContext) -> Entities:
        context.environment[perform(context, self.name)] = perform(context, self.value)
        return None


class UnsetEnvironmentVariable(Action):
    """Takes an environment variable away."""

    def __init__(self, name: SomeSubstitutions, **options: Any) -> None:
        super().__init__(**options)
        self.name = normalize(name)

    def execute(self, context: LaunchContext) -> Entities:
        context.environment.pop(perform(context, self.name), None)
        return None


class AppendEnvironmentVariable(Action):
    """Adds to an environment variable that is a list, such as PATH."""

    def __init__(
        self,
        name: SomeSubstitutions,
        value: SomeSubstitutions,
        prepend: bool = False,
        separator: SomeSubstitutions = os.pathsep,
        **options: Any,
    ) -> None:
        super().__init__(**options)
        self.name = normalize(name)
        self.value = normalize(value)
        self.prepend = prepend
        self.separator = normalize(separator)

    def execute(self, context: LaunchContext) -> Entities:
        name, value = perform(context, self.name), perform(context, self.value)
        before = context.environment.get(name)
        parts = [value] if not before else [value, before] if self.prepend else [before, value]
        context.environment[name] = perform(context, self.separator).join(parts)
        return None


class Step(LaunchDescriptionEntity):
    """A call with the context, as an entity among others."""

    def __init__(self, step: Callable[[LaunchContext], None]) -> None:
        self._step = step

    def visit(self, context: LaunchContext) -> Entities:
        self._step(context)
        return None


class GroupAction(Action):
    """Actions with a scope: what they set (arguments, namespace, environment) ends with the group."""

    def __init__(
        self,
        actions: Iterable[LaunchDescriptionEntity],
        *,
        scoped: bool = True,
        forwarding: bool = True,
        launch_configurations: Mapping[Any, SomeSubstitutions] | None = None,
        **options: Any,
    ) -> None:
        super().__init__(**options)
        self.actions = list(actions)
        self.scoped = scoped
        self.forwarding = forwarding
        self.launch_configurations = dict(launch_configurations or {})

    def get_sub_entities(self) -> Entities:
        return self.actions

    def execute(self, context: LaunchContext) -> Entities:
        values = {perform(context, name): perform(context, value) for name, value in self.launch_configurations.items()}

        def enter(context: LaunchContext) -> None:
            if self.scoped:
                context.push_configurations()
                context.push_environment()
                if not self.forwarding:
                    context.launch_configurations.clear()
            context.launch_configurations.update(values)

        def leave(context: LaunchContext) -> None:
            if self.scoped:
                context.pop_environment()
                context.pop_configurations()

        return [Step(enter), *self.actions, Step(leave)]


class LogInfo(Action):
    """Logs a message."""

    def __init__(self, *, msg: SomeSubstitutions, **options: Any) -> None:
        super().__init__(**options)
        self.msg = normalize(msg)

    def execute(self, context: LaunchContext) -> Entities:
        output.get_logger("launch.user").info(perform(context, self.msg))
        return None


class OpaqueFunction(Action):
    """Calls a function of the launch file with the context; what it returns is visited."""

    def __init__(
        self,
        *,
        function: Callable[..., SomeEntities],
        args: Iterable[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
        **options: Any,
    ) -> None:
        super().__init__(**options)
        if not callable(function):
            raise TypeError(f"OpaqueFunction expected 'function' to be callable, got '{type(function)}'")
        self._function = function
        self._args = list(args or ())
        self._kwargs = dict(kwargs or {})

    def execute(self, context: LaunchContext) -> Entities:
        return as_list(self._function(context, *self._args, **self._kwargs))


def is_substitution(value: Any) -> bool:
    """Whether a value is known only when the launch file runs."""
    return isinstance(value, Substitution) or (
        isinstance(value, (list, tuple)) and any(isinstance(part, Substitution) for part in value)
    )
