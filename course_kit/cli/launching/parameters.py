"""Parameters of a node: what a launch file gives as dictionaries, as the YAML that the node reads."""

from __future__ import annotations

import os
import tempfile
import typing
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from course_kit.cli.launching.context import LaunchContext
from course_kit.cli.launching.substitution_texts import parsed
from course_kit.cli.launching.substitutions import (
    SomeSubstitutions,
    Substitution,
    as_bool,
    as_text,
    is_substitution,
    normalize,
    perform,
)

SCALARS = (bool, int, float, str)
_UNIFORM = "the items of a parameter are of one type, bool, int, float or str, and there is one at least"
_ALLOWED = (
    "a parameter is of bytes, bool, int, float or str, or a sequence of one of the last four, and not {}. "
    "A text that looks like something else is given as ParameterValue(text, value_type=str)"
)


class ParameterValue:
    """A value with the type that it is to have: bool, int, float, str or a list of one of them."""

    def __init__(self, value: Any, *, value_type: Any = None) -> None:
        self.value = value
        self.value_type = value_type

    def evaluate(self, context: LaunchContext) -> Any:
        """The value. ValueError if the text is none of that type."""
        if self.value_type is None:
            return evaluated(context, self.value)
        if not is_substitution(self.value) and not isinstance(self.value, str):
            return _typed(self.value, self.value_type)
        text = perform(context, self.value)
        return text if self.value_type is str else _typed(_from_yaml(text), self.value_type)


class ParameterFile:
    """A YAML file of parameters."""

    def __init__(self, param_file: SomeSubstitutions, *, allow_substs: Any = False) -> None:
        self.param_file = normalize(param_file)
        self.allow_substs = allow_substs

    def evaluate(self, context: LaunchContext) -> str:
        """The path: if the file may have substitutions in it, that of a copy with what they become."""
        path = perform(context, self.param_file)
        if not as_bool(perform(context, as_text(self.allow_substs))):
            return path
        return temporary_file(context, perform(context, parsed(Path(path).read_text(encoding="utf-8"))))


def temporary_file(context: LaunchContext, text: str) -> str:
    """The path of a new file of parameters, which is there until the launch is over."""
    with tempfile.NamedTemporaryFile("w", prefix="launch_params_", delete=False, encoding="utf-8") as file:
        file.write(text)
    context.temporary_files.append(file.name)
    return file.name


def _from_yaml(text: str) -> Any:
    import yaml  # type: ignore[import-untyped]

    value = yaml.safe_load(text)
    return "" if value is None else value  # an argument that is empty stands for an empty text


def _typed(value: Any, wanted: Any) -> Any:
    """A value as the type that a ParameterValue names."""
    if typing.get_origin(wanted) in (list, Sequence):
        (item,) = typing.get_args(wanted)
        if isinstance(value, (list, tuple)):
            return [_typed(one, item) for one in value]
    elif wanted is float and isinstance(value, int) and not isinstance(value, bool):
        return float(value)
    elif type(value) is wanted:
        return value
    elif wanted is str:
        return str(value)
    raise ValueError(f"'{value}' is no {getattr(wanted, '__name__', wanted)}")


def flat(context: LaunchContext, parameters: Mapping[Any, Any], prefix: str = "") -> dict[str, Any]:
    """Parameters by their full names: those of nested dictionaries joined by dots."""
    import yaml

    found: dict[str, Any] = {}
    for name, value in parameters.items():
        full = prefix + perform(context, name)
        if isinstance(value, Mapping):
            found |= flat(context, value, f"{full}.")
        else:
            try:
                found[full] = evaluated(context, value)
            except yaml.YAMLError:
                raise TypeError(
                    f"The value of parameter {full} is no YAML: if it is meant to be a text, give it as "
                    "launch_ros.parameter_descriptions.ParameterValue(value, value_type=str)"
                ) from None
    return found


def evaluated(context: LaunchContext, value: Any) -> Any:
    """The value of a parameter; a substitution is read as YAML. TypeError for what a parameter cannot be."""
    if isinstance(value, ParameterValue):
        return value.evaluate(context)
    if isinstance(value, Substitution):
        return _checked(_from_yaml(perform(context, value)))
    if isinstance(value, (*SCALARS, bytes)):
        return value
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, Sequence):
        return _sequence(context, value)
    raise TypeError(f"{value!r} cannot be a parameter")


def _sequence(context: LaunchContext, value: Sequence[Any]) -> Any:
    if is_substitution(value) and all(isinstance(part, (str, Substitution)) for part in value):
        return _checked(_from_yaml(perform(context, value)))  # one text, made of parts
    items = [item if isinstance(item, SCALARS) else _from_yaml(perform(context, item)) for item in value]
    if items and {type(item) for item in items} == {int, float}:
        items = [float(item) for item in items]
    return _uniform(items)


def _checked(value: Any) -> Any:
    if isinstance(value, (*SCALARS, bytes)):
        return value
    if isinstance(value, (list, tuple)):
        return _uniform(list(value))
    raise TypeError(_ALLOWED.format(type(value)))


def _uniform(items: list[Any]) -> list[Any]:
    if not items or len({type(item) for item in items}) != 1 or not isinstance(items[0], SCALARS):
        raise TypeError(_UNIFORM)
    return items


def yaml_text(value: Any, in_one_line: bool) -> str:
    """A value as YAML, as nodes read it from files or, in one line, from their arguments."""
    import yaml  # type: ignore[import-untyped]

    return str(yaml.safe_dump(value, default_flow_style=in_one_line)).removesuffix("...\n")


def parameter_list(parameters: Any) -> list[Mapping[Any, Any] | ParameterFile]:
    """What a Node was given as `parameters`. TypeError if that is no list."""
    if isinstance(parameters, (str, Mapping)) or not isinstance(parameters, Iterable):
        raise TypeError(f"Node expected 'parameters' to be a list of dictionaries and files, got {parameters!r}")
    return [one if isinstance(one, (dict, ParameterFile)) else ParameterFile(one) for one in parameters]
