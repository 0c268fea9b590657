"""Substitutions: texts of a launch file that are known only when it runs."""

from __future__ import annotations

import importlib
import os
import shlex
import shutil
import subprocess
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Union

from course_kit.launching import output

if TYPE_CHECKING:
    from course_kit.launching.context import LaunchContext

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
    raise TypeError(
        f"Failed to normalize given item of type '{type(value)}', when only text and substitutions were expected."
    )


def perform(context: LaunchContext, value: SomeSubstitutions) -> str:
    """The text that the substitutions make together."""
    return "".join(context.perform_substitution(part) for part in normalize(value))


def described(value: SomeSubstitutions) -> str:
    """How --print shows a text."""
    return " + ".join(part.describe() for part in normalize(value))


TRUE, FALSE = ("true", "1"), ("false", "0")


def as_bool(text: str) -> bool:
    """The truth of a text, as conditions read it. ValueError for one that says neither."""
    word = text.strip().lower()
    if word not in TRUE + FALSE:
        raise ValueError(f"Expected 'true', 'false', '1' or '0', got '{text}'")
    return word in TRUE


class TextSubstitution(Substitution):
    """A fixed text."""

    def __init__(self, *, text: str) -> None:
        if not isinstance(text, str):
            raise TypeError(f"TextSubstitution expected 'text' to be 'str', got '{type(text)}'")
        self.text = text

    def describe(self) -> str:
        return f"'{self.text}'"

    def perform(self, context: LaunchContext) -> str:
        return self.text


class LaunchConfiguration(Substitution):
    """The value of a launch argument."""

    def __init__(self, variable_name: SomeSubstitutions, *, default: Any = None) -> None:
        self.variable_name = normalize(variable_name)
        if default is None or isinstance(default, (str, Substitution, os.PathLike, list, tuple)):
            self.default = default
        else:
            self.default = str(default)

    def describe(self) -> str:
        return f"LaunchConfig({described(self.variable_name)})"

    def perform(self, context: LaunchContext) -> str:
        name = perform(context, self.variable_name)
        if name in context.launch_configurations:
            return str(context.launch_configurations[name])
        if self.default is None:
            raise SubstitutionFailure(f"launch configuration '{name}' does not exist")
        return perform(context, self.default)


class EnvironmentVariable(Substitution):
    """The value of an environment variable."""

    def __init__(self, name: SomeSubstitutions, *, default_value: SomeSubstitutions | None = None) -> None:
        self.name = normalize(name)
        self.default_value = default_value

    def describe(self) -> str:
        return f"EnvVar({described(self.name)})"

    def perform(self, context: LaunchContext) -> str:
        name = perform(context, self.name)
        if name in context.environment:
            return context.environment[name]
        if self.default_value is None:
            raise SubstitutionFailure(f"environment variable '{name}' does not exist")
        return perform(context, self.default_value)


class LocalSubstitution(Substitution):
    """A value that the surrounding action or event set."""

    def __init__(self, expression: str, description: str | None = None) -> None:
        self.expression = expression
        self.description = description

    def describe(self) -> str:
        return f"LocalVar('{self.description or self.expression}')"

    def perform(self, context: LaunchContext) -> str:
        return str(eval(f"context.locals.{self.expression}", {}, {"context": context}))


class ThisLaunchFile(Substitution):
    """The path of the launch file."""

    def describe(self) -> str:
        return "ThisLaunchFile()"

    def perform(self, context: LaunchContext) -> str:
        return _local(context, "current_launch_file_path")


class ThisLaunchFileDir(Substitution):
    """The folder of the launch file."""

    def describe(self) -> str:
        return "ThisLaunchFileDir()"

    def perform(self, context: LaunchContext) -> str:
        return _local(context, "current_launch_file_directory")


def _local(context: LaunchContext, name: str) -> str:
    values = context.get_locals_as_dict()
    if name not in values:
        raise SubstitutionFailure("ThisLaunchFileDir used outside of a launch file (in a script)")
    return str(values[name])


class PathJoinSubstitution(Substitution):
    """Parts of a path, joined."""

    def __init__(self, substitutions: Iterable[SomeSubstitutions]) -> None:
        self.substitutions = [normalize(part) for part in substitutions]

    def describe(self) -> str:
        parts = " + ".join(described(part) for part in self.substitutions)
        return f"LocalVar('{parts}')"  # as the real one has it

    def perform(self, context: LaunchContext) -> str:
        return os.path.join(*(perform(context, part) for part in self.substitutions))


class PythonExpression(Substitution):
    """The value of a Python expression, in which the names of the math module are known."""

    def __init__(self, expression: SomeSubstitutions, python_modules: SomeSubstitutions = ("math",)) -> None:
        self.expression = normalize(expression)
        self.python_modules = normalize(python_modules)

    def describe(self) -> str:
        modules = ", ".join(part.describe() for part in self.python_modules)
        return f"PythonExpr({described(self.expression)}, [{modules}])"

    def perform(self, context: LaunchContext) -> str:
        names: dict[str, Any] = {}
        for part in self.python_modules:
            module = importlib.import_module(context.perform_substitution(part))
            if module.__name__ == "math":
                names.update(vars(module))
            names[module.__name__] = module
        return str(eval(perform(context, self.expression), {}, names))


class Command(Substitution):
    """What a command prints."""

    def __init__(self, command: SomeSubstitutions, *, on_stderr: SomeSubstitutions = "fail") -> None:
        self.command = normalize(command)
        self.on_stderr = normalize(on_stderr)

    def describe(self) -> str:
        return f"Command({described(self.command)})"

    def perform(self, context: LaunchContext) -> str:
        line = perform(context, self.command)
        on_stderr = perform(context, self.on_stderr)
        if on_stderr not in ("fail", "ignore", "warn", "capture"):
            raise SubstitutionFailure("expected 'on_stderr' to be one of: 'fail', 'ignore', 'warn' or 'capture'")
        merged = subprocess.STDOUT if on_stderr == "capture" else subprocess.PIPE
        try:
            done = subprocess.run(shlex.split(line), stdout=subprocess.PIPE, stderr=merged, text=True)
        except (FileNotFoundError, PermissionError) as error:
            raise SubstitutionFailure(f"file not found: {error}") from None
        if done.returncode != 0:
            said = f"\nCaptured stderr output: {done.stderr}" if done.stderr else ""
            raise SubstitutionFailure(f"executed command failed. Command: {line}{said}")
        if done.stderr and on_stderr in ("fail", "warn"):
            message = f"executed command showed stderr output. Command: {line}\nCaptured stderr output:\n{done.stderr}"
            if on_stderr == "fail":
                raise SubstitutionFailure(message)
            output.get_logger("launch").warning(message)
        return done.stdout


class FindExecutable(Substitution):
    """The path of a program on PATH."""

    def __init__(self, *, name: SomeSubstitutions) -> None:
        self.name = normalize(name)

    def describe(self) -> str:
        return f"FindExec({described(self.name)})"

    def perform(self, context: LaunchContext) -> str:
        name = perform(context, self.name)
        path = shutil.which(name)
        if path is None:
            raise SubstitutionFailure(f"executable '{name}' not found on the PATH")
        return path
