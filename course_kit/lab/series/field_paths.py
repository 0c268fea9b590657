"""Numeric fields of topics by their path: '/turtle1/pose.x', '/scan.ranges[0]', '/odom.pose.pose.position.x'.

Pure: works on message classes, imports no ROS. The topic ends at the first dot, as no topic has one in its name.
"""

from __future__ import annotations

import difflib
import functools
import math
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from course_kit.base.arguments import is_text, shown
from course_kit.lab.recordings.fields import NUMBERS, element_type, nested
from course_kit.ros.interface_types import Step, steps, type_name

Reader = Callable[[Any], float]
SUGGESTED = 8  # fields named when none is near
DEEPEST = 6  # messages inside messages


@dataclass(frozen=True)
class FieldPath:
    """A topic and a field of its messages."""

    topic: str  # absolute
    field: str  # 'pose.position.x', 'ranges[0]'

    def __str__(self) -> str:
        return f"{self.topic}.{self.field}"


def parse(path: str) -> FieldPath:
    """The topic and the field of a path. The field is empty if only a topic was given."""
    if not isinstance(path, str):
        raise TypeError(f"a path is a text such as '/turtle1/pose.x', not {type(path).__name__}")
    topic, _, field = path.strip().partition(".")
    if not topic.strip("/") or not is_text(path):
        raise ValueError(f"{shown(path)} is no path of a number: write it like '/turtle1/pose.x'")
    return FieldPath(topic if topic.startswith("/") else f"/{topic}", field)


def reader(message_type: Any, path: FieldPath) -> Reader:
    """A function that reads the number at `path` from a message; nan where an array is too short for its index.

    Raises ValueError, with a suggestion, for a field that is not there or is no single number.
    """
    current = message_type
    for step in steps(path.field):
        fields = current.get_fields_and_field_types() if current is not None else {}
        if step.name not in fields or len(step.indexes) > 1:
            raise ValueError(_not_there(message_type, path))
        kind = fields[step.name]
        element = element_type(kind)
        _check_index(path, step, kind, element)
        current = nested(element)
    if current is not None or element not in NUMBERS:
        raise ValueError(_no_number(message_type, path, kind))
    return functools.partial(_read, steps(path.field), element == "octet")


def _read(way: list[Step], is_octet: bool, message: Any) -> float:
    value = message
    for step in way:
        value = getattr(value, step.name)
        for index in step.indexes:
            if not -len(value) <= index < len(value):
                return math.nan
            value = value[index]
    return float(value[0] if is_octet else value)


def _check_index(path: FieldPath, step: Step, kind: str, element: str) -> None:
    """Raise ValueError for an index that nothing has, and for an array without one."""
    index = step.indexes[0] if step.indexes else None
    if element == kind:
        if index is not None:
            raise ValueError(f"{path}: {step.name} is one {kind} and no array: leave the [{index}] out")
        return
    fixed = re.search(r"\[(\d+)\]$", kind)
    if index is None:
        written = f"{path.topic}.{path.field.replace(step.name, f'{step.name}[0]', 1)}"
        raise ValueError(f"{path}: {step.name} is an array ({kind}): say which element, as in '{written}'")
    if fixed and not -int(fixed[1]) <= index < int(fixed[1]):
        raise ValueError(f"{path}: {kind} has the elements [0] to [{int(fixed[1]) - 1}], and no [{index}]")


def _not_there(message_type: Any, path: FieldPath) -> str:
    numbers = list(numeric_fields(message_type))
    what = f"has no field '{path.field}'" if path.field else "needs a field after a dot"
    near = _near(path.field, numbers)
    if near:
        hint = f" Did you mean {' or '.join(repr(f'{path.topic}.{field}') for field in near)}?"
    else:
        hint = f" Its numbers: {_some(numbers)}." if numbers else " It carries no number."
    return f"{path.topic} ({type_name(message_type)}) {what}.{hint}"


def _no_number(message_type: Any, path: FieldPath, kind: str) -> str:
    inside = [field for field in numeric_fields(message_type) if field.startswith(f"{path.field}.")]
    hint = f": give one of its numbers, as in '{path.topic}.{inside[0]}'" if inside else ": it cannot be plotted"
    return f"{path} is a {kind} and not a number{hint}"


def _near(field: str, numbers: list[str]) -> list[str]:
    """What may have been meant: the same last name elsewhere, or nearly the same path."""
    if not field:
        return []
    last = field.rsplit(".", 1)[-1]
    same_end = [number for number in numbers if f".{number}".endswith(f".{last}")]
    close = difflib.get_close_matches(field, numbers, n=2) or difflib.get_close_matches(
        field.split("[")[0], [number.split("[")[0] for number in numbers], n=1
    )
    written = {number.split("[")[0]: number for number in reversed(numbers)}
    return list(dict.fromkeys([*same_end[:2], *(written.get(name, name) for name in close)]))[:2]


def _some(numbers: list[str]) -> str:
    more = f" and {len(numbers) - SUGGESTED} more" if len(numbers) > SUGGESTED else ""
    return ", ".join(numbers[:SUGGESTED]) + more


def numeric_fields(message_type: Any, before: str = "", depth: int = DEEPEST) -> Iterator[str]:
    """Every number in a message type, as a path inside it; of arrays the first element."""
    for name, kind in message_type.get_fields_and_field_types().items():
        element = element_type(kind)
        path = f"{before}{name}" + ("" if element == kind else "[0]")
        inside = nested(element)
        if inside is not None and depth:
            yield from numeric_fields(inside, f"{path}.", depth - 1)
        elif element in NUMBERS:
            yield path
