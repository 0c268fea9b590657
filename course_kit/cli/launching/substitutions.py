"""Substitutions: texts of a launch file that are known only when it runs."""

from __future__ import annotations

import importlib
import os
from collections.abc import Iterable
from typing import Any, Union

from course_kit.cli.launching.context import LaunchContext

# What a launch file may give wherever a text is wanted.
SomeSubstitutions = Union[str, "os.PathLike[str]", "Substitution", Iterable[Any]]


class SubstitutionFailure(RuntimeError):  # noqa: N818 - the real name
    """A substitution has no value."""


class Substitution:
    """A text that is known when the launch file runs."""

    def describe(self) -> str:
        """How --print and --show-args show it."""
        return repr(self)

    def perform(self, context: LaunchContext) -> str:
        """The text."""
        raise NotImplementedError(f"{type(self).__name__} has no perform()")


def normalize(value: SomeSubstitutions) -> list[Substitution]:
    """What a launch file gave for a text, as a list of substitutions. TypeError for what is none."""
    if isinstance(value, Substitution):
        return [value]
    if isinstance(value, (str, os.PathLike)):
        return [TextSubstitution(text=os.fspath(value))]
    if isinstance(value, Iterable):
        return [part for item in value for part in normalize(item)]
    raise TypeError(f"here stand text and substitutions, and {value!r} is neither")


def perform(context: LaunchContext, value: SomeSubstitutions) -> str:
    """The text that the substitutions make together."""
    return "".join(context.perform_substitution(part) for part in normalize(value))


def described(value: SomeSubstitutions, separator: str = " + ") -> str:
    """How --print shows a text."""
    return separator.join(part.describe() for part in normalize(value))


def is_substitution(value: Any) -> bool:
    """Return True if a value is known only when the launch file runs."""
    return isinstance(value, Substitution) or (
        isinstance(value, (list, tuple)) and any(isinstance(part, Substitution) for part in value)
    )


def as_text(value: Any) -> Any:
    """A value as it is if it can be a text of a launch file, else as Python prints it."""
    return value if isinstance(value, (str, Substitution, os.PathLike, list, tuple)) else str(value)


def as_bool(text: str) -> bool:
    """The truth of a text, as conditions read it. ValueError for one that says neither."""
    truth = {"true": True, "1": True, "false": False, "0": False}.get(text.strip().lower())
    if truth is None:
        raise ValueError(f"'{text}' is none of true, false, 1 and 0")
    return truth


class Composed(Substitution):
    """A substitution of texts, which are its attributes: `_text` makes one of them when the launch file runs."""

    shown = "{type}()"  # how --print shows it, with the texts by their names

    def __init__(self, **texts: SomeSubstitutions) -> None:
        self._texts = {name: normalize(text) for name, text in texts.items()}
        vars(self).update(self._texts)

    def describe(self) -> str:
        """How --print and --show-args show it."""
        texts = {name: described(text) for name, text in self._texts.items()}
        return self.shown.format(type=type(self).__name__, **texts)

    def perform(self, context: LaunchContext) -> str:
        """The text."""
        return self._text(context, *(perform(context, text) for text in self._texts.values()))

    def _text(self, context: LaunchContext, *texts: Any) -> str:
        raise NotImplementedError


class TextSubstitution(Substitution):
    """A fixed text."""

    def __init__(self, *, text: str) -> None:
        if not isinstance(text, str):
            raise TypeError(f"TextSubstitution stands for text, and {text!r} is none")
        self.text = text

    def describe(self) -> str:
        """The text in quotes."""
        return f"'{self.text}'"

    def perform(self, context: LaunchContext) -> str:
        """The text."""
        return self.text


class LaunchConfiguration(Composed):
    """The value of a launch argument."""

    shown = "LaunchConfig({variable_name})"

    def __init__(self, variable_name: SomeSubstitutions, *, default: Any = None) -> None:
        super().__init__(variable_name=variable_name)
        self.default = None if default is None else as_text(default)

    def _text(self, context: LaunchContext, name: str) -> str:
        if name in context.launch_configurations:
            return str(context.launch_configurations[name])
        if self.default is None:
            raise SubstitutionFailure(f"nothing has set the launch configuration '{name}'")
        return perform(context, self.default)


class EnvironmentVariable(Composed):
    """The value of an environment variable."""

    shown = "EnvVar({name})"

    def __init__(self, name: SomeSubstitutions, *, default_value: SomeSubstitutions | None = None) -> None:
        super().__init__(name=name)
        self.default_value = default_value

    def _text(self, context: LaunchContext, name: str) -> str:
        if name in context.environment:
            return context.environment[name]
        if self.default_value is None:
            raise SubstitutionFailure(f"the environment has no variable '{name}'")
        return perform(context, self.default_value)


class LocalSubstitution(Substitution):
    """A value that the surrounding action or event set."""

    def __init__(self, expression: str, description: str | None = None) -> None:
        self.expression = expression
        self.description = description

    def describe(self) -> str:
        """Its description or expression."""
        return f"LocalVar('{self.description or self.expression}')"

    def perform(self, context: LaunchContext) -> str:
        """The value."""
        return str(eval(f"context.locals.{self.expression}", {}, {"context": context}))


class ThisLaunchFile(Composed):
    """The path of the launch file."""

    _local = "current_launch_file_path"

    def _text(self, context: LaunchContext) -> str:
        values = context.get_locals_as_dict()
        if self._local not in values:
            raise SubstitutionFailure("this program is no launch file, which has a path and a folder")
        return str(values[self._local])


class ThisLaunchFileDir(ThisLaunchFile):
    """The folder of the launch file."""

    _local = "current_launch_file_directory"


class PathJoinSubstitution(Substitution):
    """Parts of a path, joined."""

    def __init__(self, substitutions: Iterable[SomeSubstitutions]) -> None:
        self.substitutions = [normalize(part) for part in substitutions]

    def describe(self) -> str:
        """The parts, as the real one has them."""
        return f"LocalVar('{described(self.substitutions)}')"

    def perform(self, context: LaunchContext) -> str:
        """The path."""
        return os.path.join(*(perform(context, part) for part in self.substitutions))


class PythonExpression(Substitution):
    """The value of a Python expression, in which the names of the math module are known."""

    def __init__(self, expression: SomeSubstitutions, python_modules: SomeSubstitutions = ("math",)) -> None:
        self.expression = normalize(expression)
        self.python_modules = normalize(python_modules)

    def describe(self) -> str:
        """The expression and the modules."""
        return f"PythonExpr({described(self.expression)}, [{described(self.python_modules, ', ')}])"

    def perform(self, context: LaunchContext) -> str:
        """The value."""
        names: dict[str, Any] = {}
        for part in self.python_modules:
            module = importlib.import_module(context.perform_substitution(part))
            if module.__name__ == "math":
                names.update(vars(module))
            names[module.__name__] = module
        return str(eval(perform(context, self.expression), {}, names))
