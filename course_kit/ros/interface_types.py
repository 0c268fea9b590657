"""Names of interface types, their classes, those in a definition, paths of fields. Pure: imports no ROS itself."""

from __future__ import annotations

import difflib
import importlib
import re
import sys
from typing import Any, NamedTuple


def type_name(interface: Any) -> str:
    """The name of a class: 'std_msgs/msg/String', 'std_srvs/srv/SetBool', 'example_interfaces/action/Fibonacci'."""
    package, kind = interface.__module__.split(".")[:2]
    return f"{package}/{kind}/{interface.__name__}"


def message_class(type_name: str) -> Any:
    """The Python class of a type name such as 'std_msgs/msg/String'.

    Raises ValueError for what is no type name or no message of its package, ModuleNotFoundError for a package that
    is not there.
    """
    package, kind, name = _split(type_name)
    try:
        module = importlib.import_module(f"{package}.{kind}")
    except ModuleNotFoundError:
        raise ModuleNotFoundError(
            f"{type_name}: this Python does not know the package {package}, so it cannot read its messages. "
            f"Build it in your workspace (colcon build), source install/setup.bash and start again."
        ) from None
    # The parts of actions and services, for instance Fibonacci_FeedbackMessage, live beside their main class.
    main = getattr(module, name.split("_")[0], None)
    if kind != "msg" and main is not None:
        module = sys.modules[main.__module__]
    if not hasattr(module, name):
        near = difflib.get_close_matches(name, [n for n in dir(module) if n[0].isupper()], n=1)
        hint = f" Did you mean {package}/{kind}/{near[0]}?" if near else ""
        raise ValueError(f"the package {package} has no message {name}.{hint}")
    return getattr(module, name)


def _split(type_name: str) -> tuple[str, str, str]:
    parts = type_name.split("/")
    if len(parts) == 2:
        parts.insert(1, "msg")
    if len(parts) != 3 or parts[1] not in ("msg", "srv", "action") or not all(p.isidentifier() for p in parts):
        raise ValueError(f"{type_name!r} is not a message type. Write it like 'std_msgs/msg/String'.")
    return parts[0], parts[1], parts[2]


def nested_types(definition: Any) -> list[str]:
    """The types of fields, as rosidl_adapter has parsed them, that are messages themselves: 'std_msgs/msg/Header'."""
    types = (field.type for field in definition.fields)
    return [f"{t.pkg_name}/msg/{t.type}" for t in types if not t.is_primitive_type()]


class Step(NamedTuple):
    """One step of a field's path: a field, and which of its elements."""

    written: str
    name: str
    indexes: tuple[int, ...]


def steps(path: str) -> list[Step]:
    """The steps of a path such as 'poses[0].position'. What is none is a step to a field of that name."""
    found = [(word, re.fullmatch(r"([^\[\]]*)((?:\[-?\d{1,18}\])*)", word)) for word in path.split(".")]
    return [
        Step(word, match[1], tuple(map(int, re.findall(r"-?\d+", match[2])))) if match else Step(word, word, ())
        for word, match in found
    ]
