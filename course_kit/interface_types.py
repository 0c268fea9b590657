"""Names of interface types, those in a definition, and paths of fields. Pure: classes and texts, imports no ROS."""

from __future__ import annotations

import re
from typing import Any, NamedTuple

NUMBERS = frozenset(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)) | {"float32", "float64"}
PRIMITIVES = NUMBERS | {"bool", "byte", "char", "string", "wstring", "time", "duration"}


def type_name(interface: Any) -> str:
    """The name of a class: 'std_msgs/msg/String', 'std_srvs/srv/SetBool', 'example_interfaces/action/Fibonacci'."""
    package, kind = interface.__module__.split(".")[:2]
    return f"{package}/{kind}/{interface.__name__}"


def nested_type(text: str, package: str) -> str | None:
    """The type of a line's field, of a definition, if it is a message itself: 'std_msgs/msg/Header'."""
    kind, _, rest = text.replace("\t", " ").split("#")[0].partition(" ")
    name = re.sub(r"\[[^\]]*\]$", "", kind)
    if not rest.strip() or "=" in rest or re.sub("<=.*", "", name) in PRIMITIVES:
        return None
    parts = name.split("/") if "/" in name else [package, name]
    is_type = len(parts) == 2 and all(part.isidentifier() for part in parts)
    return "/msg/".join(parts) if is_type else None


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
