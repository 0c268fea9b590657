"""Actions that set values, group others, log, and call functions of the launch file."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from course_kit.cli.launching import output
from course_kit.cli.launching.context import LaunchContext
from course_kit.cli.launching.entities import Action, Entities, LaunchDescriptionEntity
from course_kit.cli.launching.handlers import SomeEntities, as_list
from course_kit.cli.launching.substitutions import SomeSubstitutions, Substitution, normalize, perform


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
        self._conditionally_included = self._is_given_by_an_include = False
        if self.choices is None:
            return
        if not self.choices:
            self._refuse("there is nothing to choose from: leave `choices` out if every value may be given")
        if isinstance(default_value, str) and default_value not in self.choices:
            self._refuse(f'"{default_value}", which is to be the default value, is none of the choices {self.choices}')

    @staticmethod
    def _refuse(message: str) -> None:
        output.get_logger("launch.actions.declare_launch_argument").error(message)
        raise RuntimeError(message)

    def execute(self, context: LaunchContext) -> None:
        """Give the argument its default value if it has none yet; refuse one that is none of the choices."""
        values = context.launch_configurations
        if self.name not in values:
            if self.default_value is None:
                logger = output.get_logger("launch.actions.declare_launch_argument")
                logger.error(f"{self.name} ({self.description}) has no value")
                raise RuntimeError(f"the launch file needs a value: give it {self.name}:=...")
            values[self.name] = perform(context, self.default_value)
        if self.choices is not None and values[self.name] not in self.choices:
            self._refuse(f"{self.name}:={values[self.name]} is none of the choices {self.choices}")


def _description(given: str | None, choices: list[str] | None) -> str:
    if choices is None:
        return given if given is not None else "no description given"
    if given is None:
        return f"One of: {choices}"
    return f"{given}{'' if given.endswith('.') else '.'} Valid choices are: {choices}"


class TextAction(Action):
    """An action that is given texts, which are its attributes: `_act` gets what they are when it is executed."""

    def __init__(self, texts: Mapping[str, SomeSubstitutions], **options: Any) -> None:
        super().__init__(**options)
        self._texts = {name: normalize(text) for name, text in texts.items()}
        vars(self).update(self._texts)

    def execute(self, context: LaunchContext) -> None:
        """Perform the texts, and act on them."""
        self._act(context, *(perform(context, text) for text in self._texts.values()))

    def _act(self, context: LaunchContext, *texts: Any) -> None:
        raise NotImplementedError


class SetLaunchConfiguration(TextAction):
    """Gives a launch configuration a value."""

    def __init__(self, name: SomeSubstitutions, value: SomeSubstitutions, **options: Any) -> None:
        super().__init__({"name": name, "value": value}, **options)

    def _act(self, context: LaunchContext, name: str, value: str) -> None:
        context.launch_configurations[name] = value


class UnsetLaunchConfiguration(TextAction):
    """Takes a launch configuration away."""

    def __init__(self, name: SomeSubstitutions, **options: Any) -> None:
        super().__init__({"name": name}, **options)

    def _act(self, context: LaunchContext, name: str) -> None:
        context.launch_configurations.pop(name, None)


class SetEnvironmentVariable(TextAction):
    """Sets an environment variable for the processes that are started after it."""

    def __init__(self, name: SomeSubstitutions, value: SomeSubstitutions, **options: Any) -> None:
        super().__init__({"name": name, "value": value}, **options)

    def _act(self, context: LaunchContext, name: str, value: str) -> None:
        context.environment[name] = value


class UnsetEnvironmentVariable(TextAction):
    """Takes an environment variable away."""

    def __init__(self, name: SomeSubstitutions, **options: Any) -> None:
        super().__init__({"name": name}, **options)

    def _act(self, context: LaunchContext, name: str) -> None:
        context.environment.pop(name, None)


class AppendEnvironmentVariable(TextAction):
    """Adds to an environment variable that is a list, such as PATH."""

    def __init__(
        self,
        name: SomeSubstitutions,
        value: SomeSubstitutions,
        prepend: bool = False,
        separator: SomeSubstitutions = os.pathsep,
        **options: Any,
    ) -> None:
        super().__init__({"name": name, "value": value, "separator": separator}, **options)
        self.prepend = prepend

    def _act(self, context: LaunchContext, name: str, value: str, separator: str) -> None:
        before = context.environment.get(name)
        parts = [value] if not before else [value, before] if self.prepend else [before, value]
        context.environment[name] = separator.join(parts)


class LogInfo(TextAction):
    """Logs a message."""

    msg: list[Substitution]

    def __init__(self, *, msg: SomeSubstitutions, **options: Any) -> None:
        super().__init__({"msg": msg}, **options)

    def _act(self, context: LaunchContext, msg: str) -> None:
        output.get_logger("launch.user").info(msg)


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
        """The actions of the group."""
        return self.actions

    def execute(self, context: LaunchContext) -> Entities:
        """Open the scope, visit the actions, close it."""
        values = {perform(context, name): perform(context, value) for name, value in self.launch_configurations.items()}
        if self.scoped:
            context.push_scope()
            if not self.forwarding:
                context.forget_values()
        context.launch_configurations.update(values)
        return [*self.actions, OpaqueFunction(function=LaunchContext.pop_scope)] if self.scoped else self.actions


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
            raise TypeError(f"OpaqueFunction calls a function, which {function!r} is not")
        self._function = function
        self._args = list(args or ())
        self._kwargs = dict(kwargs or {})

    def execute(self, context: LaunchContext) -> Entities:
        """Call the function."""
        return as_list(self._function(context, *self._args, **self._kwargs))
