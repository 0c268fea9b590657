"""Names of interface types, those in a definition, and paths of fields. Pure: classes and texts, imports no ROS."""

from __future__ import annotations

import re
from typing import Any, NamedTuple


def type_name(interface: Any) -> str:
    """The name of a class: 'std_msgs/msg/String', 'std_srvs/srv/SetBool', 'example_interfaces/action/Fibonacci'."""
    package, kind = interface.__module__.split(".")[:2]
    return f"{package}/{kind}/{interface.__name__}"


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
    found = [(word, re.fullmatch(r"([^\[\]]*)((?:\[-?\d+\])*)", word)) for word in path.split(".")]
    return [
        Step(word, match[1], tuple(map(int, re.findall(r"-?\d+", match[2])))) if match else Step(word, word, ())
        for word, match in found
    ]
