"""The fields of a message class as a tree, and what is typed into them read as values. Imports no ROS.

A field's entry is what its input holds: a truth value for a boolean; a text for a number, a string and a time; a
dictionary of entries for a message; a list of entries for an array. The value that is read from it is what
`populate()` takes, as if it had been written as YAML.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from decimal import Decimal, InvalidOperation
from typing import Any

from rosidl_parser.definition import (  # type: ignore[import-untyped]
    AbstractGenericString,
    AbstractNestedType,
    AbstractWString,
    Array,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    NamespacedType,
)

from course_kit.base.arguments import is_text, shown
from course_kit.cli.ros2.messages.yaml_text import fields
from course_kit.ros.interface_types import message_class

NOW = "now"  # stands for the time of sending
TIME, DURATION = "builtin_interfaces/Time", "builtin_interfaces/Duration"
MOST_ELEMENTS = 100  # that can be added to an array; a longer one is for a program to make
LARGEST_FLOAT32 = 3.402823466e38  # as rosidl has it
# The types of .msg files, where rosidl's are called otherwise.
_NAMES = {"boolean": "bool", "octet": "byte", "float": "float32", "double": "float64"}
_FLOATS = {"float32": LARGEST_FLOAT32, "float64": math.inf, "long double": math.inf}
_SECONDS = (-(2**31), 2**31)  # of times and durations: from, and below


@dataclass(frozen=True)
class Field:
    """A field of a message, an element of an array, or the message itself, whose name is empty."""

    name: str
    kind: str  # boolean, number, text, time, message or array
    type: str  # as in a .msg file
    default: Any  # the entry that it begins with
    fields: tuple[Field, ...] = ()  # of a message
    element: Field | None = None  # of an array, with the bounds of how many there are
    least: int = 0
    most: int = 0
    constants: dict[str, Any] = field(default_factory=dict)  # of its message, that can stand for its value
    choices: tuple[str, ...] = ()  # those of them that are named after it

    def as_data(self) -> dict[str, Any]:
        """The tree as dictionaries, for the page."""
        return asdict(self)


def message_field(message: Any) -> Field:
    """The tree of a message, a service's request or an action's goal; it begins with what the message holds."""
    return _message("", type(message), message)


def _message(name: str, message_type: Any, default: Any) -> Field:
    constants = {
        key: getattr(message_type, key)
        for key, value in vars(type(message_type)).items()
        if isinstance(value, property) and key.isupper() and not key.endswith("__DEFAULT")
    }
    inside = tuple(_field(name, slot, getattr(default, name), constants) for name, slot in fields(message_type))
    type_name = f"{message_type.__module__.partition('.')[0]}/{message_type.__name__}"
    return Field(name, "message", type_name, {one.name: one.default for one in inside}, inside)


def _field(name: str, slot: Any, default: Any, constants: dict[str, Any]) -> Field:
    if isinstance(slot, AbstractNestedType):
        return _array(name, slot, default, constants)
    if isinstance(slot, NamespacedType):
        kind = f"{slot.namespaces[0]}/{slot.name}"
        if kind in (TIME, DURATION):
            return Field(name, "time", kind, seconds_text(default.sec, default.nanosec))
        return _message(name, type(default), default)
    type_name = _type_of(slot)
    if type_name == "bool":
        return Field(name, "boolean", type_name, default)
    is_text_field = isinstance(slot, AbstractGenericString)
    fitting = {key: value for key, value in constants.items() if isinstance(value, str) == is_text_field}
    named = tuple(key for key in fitting if key.startswith(f"{name.upper()}_"))
    text = default if is_text_field else str(default[0]) if isinstance(default, bytes) else repr(default)
    return Field(name, "text" if is_text_field else "number", type_name, text, constants=fitting, choices=named)


def _type_of(slot: Any) -> str:
    if isinstance(slot, AbstractGenericString):
        bound = f"<={slot.maximum_size}" if isinstance(slot, BoundedString | BoundedWString) else ""
        return f"{'wstring' if isinstance(slot, AbstractWString) else 'string'}{bound}"
    return _NAMES.get(slot.typename, slot.typename)


def _array(name: str, slot: Any, default: Any, constants: dict[str, Any]) -> Field:
    inner = slot.value_type
    if isinstance(inner, NamespacedType):
        one = message_class("/".join(inner.namespaced_name()))()
    else:
        one = False if _type_of(inner) == "bool" else "" if isinstance(inner, AbstractGenericString) else 0
    if not isinstance(inner, NamespacedType) and _type_of(inner) in _FLOATS:
        one = 0.0
    element = _field("", inner, one, constants)
    if isinstance(slot, Array):
        least = most = slot.size
        bound = str(slot.size)
    else:
        least, most = 0, MOST_ELEMENTS
        bound = ""
        if isinstance(slot, BoundedSequence):
            most, bound = min(slot.maximum_size, MOST_ELEMENTS), f"<={slot.maximum_size}"
    entries = [_field("", inner, value, constants).default for value in getattr(default, "tolist", lambda: default)()]
    return Field(name, "array", f"{element.type}[{bound}]", entries, element=element, least=least, most=most)


# What is typed in ----------------------------------------------------------------------------------------------


class Unfit(ValueError):  # noqa: N818 - reads as what happened
    """A text that its field cannot hold; the message says what the field takes."""


def read(root: Field, entries: Any) -> tuple[Any, dict[str, str]]:
    """The value of a message's entries, and by path one sentence for each that does not fit; None for those."""
    problems: dict[str, str] = {}
    return _read(root, entries, "", problems), problems


def _read(one: Field, entry: Any, path: str, problems: dict[str, str]) -> Any:
    try:
        if one.kind == "message":
            given = entry if isinstance(entry, dict) else {}
            return {
                inner.name: _read(
                    inner, given.get(inner.name, inner.default), f"{path}.{inner.name}".lstrip("."), problems
                )
                for inner in one.fields
            }
        if one.kind == "array" and one.element is not None:
            _check_count(one, entry)
            return [_read(one.element, item, f"{path}[{number}]", problems) for number, item in enumerate(entry)]
        return parse(one, entry)
    except Unfit as error:
        problems[path] = f"{path} {error}"
        return None


def _check_count(one: Field, entry: Any) -> None:
    if not isinstance(entry, list) or not one.least <= len(entry) <= one.most:
        wanted = f"{one.least}" if one.least == one.most else f"at most {one.most}"
        has = len(entry) if isinstance(entry, list) else "none"
        raise Unfit(f"is {one.type}: it takes {wanted} elements here, and has {has}.")


def parse(one: Field, entry: Any) -> Any:
    """The value of one entry. Unfit, as the end of a sentence that begins with the field, if it is none."""
    if one.kind == "boolean":
        if isinstance(entry, bool):
            return entry
        raise Unfit(f"takes true or false, not {shown(entry)}.")
    if not isinstance(entry, str):
        raise Unfit(f"takes a text, not {shown(entry)}.")
    if entry.strip() in one.constants:
        return one.constants[entry.strip()]
    return {"text": _text, "time": _time, "number": _number}[one.kind](one, entry)


def _text(one: Field, entry: str) -> str:
    if not is_text(entry):
        raise Unfit(f"takes a {one.type} that can be sent: this one has half a character, or a NUL, in it.")
    longest = int(one.type.partition("<=")[2] or len(entry))
    if len(entry) > longest:
        raise Unfit(f"takes a string of at most {longest} characters, and this one has {len(entry)}.")
    return entry


def _number(one: Field, entry: str) -> Any:
    text = entry.strip()
    if one.type in _FLOATS:
        return _float(one.type, text)
    low, high = integer_range(one.type)
    for base in (10, 0):
        try:
            number = int(text, base)
        except ValueError:
            continue
        if low <= number <= high:
            return number
    raise Unfit(f"takes {_an(one.type)}, a whole number from {low} to {high}, not {shown(entry)}.")


def _float(type_name: str, text: str) -> float:
    largest = _FLOATS[type_name]
    hint = ", with a point and no comma" if "," in text else ""
    try:
        number = float(text)
    except ValueError:
        raise Unfit(f"takes {_an(type_name)}, a number such as 0.5{hint}, not {shown(text)}.") from None
    if math.isfinite(number) and abs(number) > largest:
        raise Unfit(f"takes {_an(type_name)}, a number from {-largest} to {largest}, not {shown(text)}.")
    return number


def integer_range(type_name: str) -> tuple[int, int]:
    """The smallest and the largest number of a type such as 'uint8'."""
    if type_name == "byte":
        return 0, 255
    bits = int(type_name.lstrip("uint"))
    return (0, 2**bits - 1) if type_name.startswith("u") else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


def _an(type_name: str) -> str:
    return f"an {type_name}" if type_name.startswith("int") else f"a {type_name}"


def _time(one: Field, entry: str) -> Any:
    """A time or a duration in seconds as `sec` and `nanosec`; NOW stays, for populate() knows it."""
    text, is_time = entry.strip(), one.type == TIME
    if is_time and text == NOW:
        return NOW
    low, high = _SECONDS
    try:
        nanoseconds = int(Decimal(text).scaleb(9).to_integral_value())
    except (InvalidOperation, ValueError, OverflowError):  # of nan and infinity
        nanoseconds = high * 10**9
    sec, nanosec = divmod(nanoseconds, 10**9)
    if not low <= sec < high:
        also = f"or {NOW}, " if is_time else ""
        raise Unfit(f"takes seconds such as 1.5, from {low} to below {high}, {also}not {shown(entry)}.")
    return {"sec": sec, "nanosec": nanosec}


def seconds_text(sec: int, nanosec: int) -> str:
    """A time or a duration as it is typed in."""
    return format((sec + Decimal(nanosec).scaleb(-9)).normalize(), "f")


def changed(one: Field, value: Any) -> Any:
    """Of a message's value what differs from its defaults."""
    return {
        inner.name: _shortest(inner, value[inner.name]) for inner in one.fields if _differs(inner, value[inner.name])
    }


def _shortest(one: Field, value: Any) -> Any:
    if one.kind == "message":
        return changed(one, value)
    if one.kind == "array" and one.element is not None:
        return [_shortest(one.element, item) for item in value]
    return value


def _differs(one: Field, value: Any) -> bool:
    return repr(value) != repr(_read(one, one.default, "", {}))  # nan is nan, and -0.0 is not 0.0
