"""YAML text into messages, as `ros2 topic pub`, `service call` and `action send_goal` take it. Imports no ROS."""

from __future__ import annotations

import math
from array import array
from collections.abc import Sequence
from typing import Any

import yaml
from rosidl_parser.definition import (  # type: ignore[import-untyped]
    AbstractGenericString,
    AbstractNestedType,
    BasicType,
    NamespacedType,
)

from course_kit.cli.ros2.messages.yaml_text import fields
from course_kit.cli.ros2.verbs import one_line
from course_kit.ros.interface_types import message_class
from course_kit.ros.private_api.rosidl_parts import check_fields

HEADER = ("std_msgs", "msg", "Header")
TIME = ("builtin_interfaces", "msg", "Time")
_SWITCHES = {False: ("off", "no", "false"), True: ("on", "yes", "true")}  # which YAML reads as truth values
MOST_VALUES = 1_000_000  # with aliases, a line of text can stand for more than the memory holds
LARGEST_FLOAT32 = 3.4028234663852886e38
_PYTHON_TYPES = {"boolean": bool, "float": float, "double": float, "long double": float, "char": str, "wchar": str}


class NotYaml(ValueError):  # noqa: N818  (reads as what happened)
    """The text is no YAML; the message says what is wrong and where, in one line."""


def parse(text: str | bytes) -> Any:
    """The value that a YAML text stands for. Raises NotYaml."""
    try:
        value = yaml.safe_load(text)
        if _count(value, {}) > MOST_VALUES:
            raise NotYaml(f"its aliases stand for more than {MOST_VALUES} values")
        return value
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        where = f"(line {mark.line + 1}, column {mark.column + 1})" if mark else ""
        raise NotYaml(" ".join(f"{error.context or ''} {error.problem or ''} {where}".split())) from None
    except RecursionError:
        raise NotYaml("it is nested too deep") from None
    except (yaml.YAMLError, ValueError, TypeError, OverflowError) as error:
        raise NotYaml(one_line(error)) from None
    except (AttributeError, LookupError):  # PyYAML's own, of a tag
        raise NotYaml("a value does not fit its tag, as in '!!int x'") from None


def _count(value: Any, counts: dict[int, float]) -> float:
    """How many values there are if each alias is written out; infinitely many if one stands inside itself."""
    if not isinstance(value, (dict, list)):
        return 1
    if id(value) not in counts:
        counts[id(value)] = math.inf  # until it is counted
        inside = value.values() if isinstance(value, dict) else value
        counts[id(value)] = 1 + sum(_count(one, counts) for one in inside)
    return counts[id(value)]


def populate(message: Any, values: Any) -> list[Any]:
    """Set fields of a message from parsed YAML; the times in it that stand for the time of sending.

    Those are `now` for a builtin_interfaces/Time and `auto` for a std_msgs/Header: pass the list to stamp() before
    each sending. A value is converted to the type of its field where Python can do so. Raises AttributeError for
    a field that is not there; TypeError, ValueError, OverflowError or AssertionError for a value that does not fit.
    """
    times: list[Any] = []
    _set_fields(message, values, times)
    return times


def stamp(times: Sequence[Any], sec: int, nanosec: int) -> None:
    """Set the times that populate() returned."""
    for time in times:
        time.sec, time.nanosec = sec, nanosec


def _set_fields(message: Any, values: Any, times: list[Any]) -> None:
    if not isinstance(values, dict):
        raise _unfit(type(message), values)
    slots = dict(fields(type(message)))
    for key, value in values.items():
        name = next((n for n in _SWITCHES.get(key, ()) if n in slots), key) if isinstance(key, bool) else key
        if name not in slots:
            raise AttributeError(f"'{type(message).__name__}' object has no attribute '{name}'")
        converted = _converted(slots[name], getattr(message, name), value, times)
        # The generated setters then check ranges, lengths and bounds; by their rounding this number is too large.
        check_fields(message, not (isinstance(converted, float) and abs(converted) == LARGEST_FLOAT32))
        setattr(message, name, converted)


def _unfit(wanted: type, value: Any) -> Exception:
    """The real command's error for a value that cannot become what the field wants."""
    if isinstance(value, dict) and value:
        return AttributeError(f"'{wanted.__name__}' object has no attribute '{next(iter(value))}'")
    return TypeError(f"Value '{value}' is expected to be a dictionary but is a {type(value).__name__}")


def _converted(slot: Any, default: Any, value: Any, times: list[Any]) -> Any:
    """A value for a field of the rosidl type `slot`; `default` is what the field holds now."""
    if isinstance(slot, AbstractNestedType):
        return _sequence(slot.value_type, default, value, times)
    if isinstance(slot, NamespacedType):
        return _message(slot, type(default), value, times)
    return _single(slot, value)


def _message(slot: NamespacedType, kind: Any, value: Any, times: list[Any]) -> Any:
    message = kind()
    name = tuple(slot.namespaced_name())
    if name == TIME and value == "now":
        times.append(message)
    elif name == HEADER and value == "auto":
        times.append(message.stamp)
    else:
        _set_fields(message, value, times)
    return message


def _sequence(element: Any, default: Any, value: Any, times: list[Any]) -> Any:
    if isinstance(default, array):
        return array(default.typecode, value)
    if hasattr(default, "dtype"):
        import numpy as np

        return np.array(value, dtype=default.dtype).ravel()
    try:
        values = list(value)
    except TypeError:
        raise _unfit(list, value) from None
    if isinstance(element, NamespacedType):
        kind = message_class("/".join(element.namespaced_name()))
        return [_message(element, kind, item, times) for item in values]
    return [_single(element, item) for item in values]


def _single(slot: Any, value: Any) -> Any:
    """A number, a string or a byte."""
    if isinstance(slot, BasicType) and slot.typename == "octet":
        return _byte(value)
    kind = str if isinstance(slot, AbstractGenericString) else _PYTHON_TYPES.get(slot.typename, int)
    try:
        converted: Any = value if type(value) is kind else kind(value)
    except TypeError:
        raise _unfit(kind, value) from None
    if kind is str:
        converted.encode()  # a lone surrogate, which YAML can write, is in no UTF-8: UnicodeEncodeError
    return converted


def _byte(value: Any) -> bytes:
    """A byte from a number, or from the character that `echo` prints for it."""
    if isinstance(value, int) and 0 <= value <= 255:
        return bytes([value])
    if isinstance(value, str) and len(value) == 1 and ord(value) <= 255:
        return value.encode("latin-1")
    if isinstance(value, bytes) and len(value) == 1:
        return value
    raise ValueError(f"a byte is a number from 0 to 255 or one character, not {value!r}")
