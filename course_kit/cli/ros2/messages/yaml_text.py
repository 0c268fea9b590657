"""Messages as text: the YAML and the comma-separated values that `ros2 topic echo` prints. Imports no ROS.

Block style, the common one, is written here directly: several times faster than PyYAML's emitter in Python, and the
same to the byte. What is rare (strings that need quotes, flow style) is left to PyYAML.
"""

from __future__ import annotations

import re
import sys
from array import array
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import yaml
from rosidl_parser.definition import (  # type: ignore[import-untyped]
    AbstractGenericString,
    AbstractWString,
    Array,
    BoundedSequence,
    NamespacedType,
)

MORE = "..."  # what stands for the rest of a truncated value
_PLAIN = re.compile(r"[A-Za-z/][A-Za-z0-9_/]*")
_RARE_BREAKS = re.compile("[\x85\u2028\u2029]")
_NOT_STRINGS = frozenset({"yes", "no", "true", "false", "on", "off", "null"})  # what YAML takes for something else


@dataclass(frozen=True)
class Shown:
    """What of a message is shown: at most so many elements and characters of a field (None: all), arrays, strings."""

    truncate_length: int | None = None
    no_arr: bool = False
    no_str: bool = False


EVERYTHING = Shown()
Fields = tuple[tuple[str, Any], ...]
_fields: dict[Any, Fields] = {}


def to_yaml(message: Any, shown: Shown = EVERYTHING, flow_style: bool = False) -> str:
    """A message as YAML that ends with a newline; `flow_style` writes sequences in brackets."""
    if flow_style or not fields(type(message)):
        return dump(to_dict(message, shown), flow_style)
    lines: list[str] = []
    _write_fields(message, 0, shown, lines)
    lines.append("")
    return "\n".join(lines)


def fields(message_type: Any) -> Fields:
    """The fields of a message class, in order, each with its rosidl type."""
    if message_type not in _fields:
        pairs = zip(message_type.get_fields_and_field_types(), message_type.SLOT_TYPES, strict=True)
        _fields[message_type] = tuple(pairs)
    return _fields[message_type]


def to_flow_yaml(data: Any) -> str:
    """Python data as YAML on one line, as it is typed behind a command: '{linear: {x: 2.0}}'."""
    text: str = yaml.dump(
        data, Dumper=_FlowDumper, allow_unicode=True, width=sys.maxsize, default_flow_style=True, sort_keys=False
    )
    return text.removesuffix("\n").removesuffix("\n...")


# Values as Python data -------------------------------------------------------------------------------------------


def to_dict(message: Any, shown: Shown = EVERYTHING) -> dict[str, Any]:
    """A message as a dictionary in the order of its fields, of numbers, strings, lists and dictionaries."""
    return {name: _value(getattr(message, name), slot, shown) for name, slot in fields(type(message))}


def _value(value: Any, slot: Any, shown: Shown) -> Any:
    if isinstance(value, (bool, int, float)):
        return value
    if isinstance(value, (str, bytes)):
        return _characters(value, shown)
    if not _is_sequence(value):
        return to_dict(value, shown)
    if shown.no_arr and slot is not None:
        return abbreviation(slot, len(value))
    kept, is_cut = _elements(value, shown)
    return [_value(element, None, shown) for element in kept] + ([MORE] if is_cut else [])


def _is_sequence(value: Any) -> bool:
    return isinstance(value, (list, tuple)) or hasattr(value, "tolist")  # arrays of Python and of numpy


def _elements(value: Any, shown: Shown) -> tuple[Any, bool]:
    """The elements that are shown, and whether there are more."""
    kept = value[: shown.truncate_length]
    return (kept.tolist() if hasattr(kept, "tolist") else kept), len(kept) < len(value)


def _characters(value: str | bytes, shown: Shown) -> str:
    if isinstance(value, bytes):
        value = value.decode("latin-1")
    elif shown.no_str:
        return f"<string length: <{len(value)}>>"
    kept = value[: shown.truncate_length]
    return kept + MORE if len(kept) < len(value) else value


def abbreviation(slot: Any, length: int) -> str:
    """What stands for a sequence when arrays are not shown."""
    element = _type_name(slot.value_type)
    if isinstance(slot, Array):
        return f"<array type: {element}[{slot.size}]>"
    bound = f"[{slot.maximum_size}]" if isinstance(slot, BoundedSequence) else ""
    return f"<sequence type: {element}{bound}, length: {length}>"


def _type_name(slot: Any) -> str:
    if isinstance(slot, NamespacedType):
        return "/".join(slot.namespaced_name())
    if isinstance(slot, AbstractGenericString):
        return "wstring" if isinstance(slot, AbstractWString) else "string"
    return str(slot.typename)


# Block style -----------------------------------------------------------------------------------------------------


def _write_fields(message: Any, indent: int, shown: Shown, lines: list[str]) -> None:
    """Append the lines of a message that has fields, each indented by so many spaces."""
    margin = " " * indent
    for name, slot in fields(type(message)):
        key, value = _string(name, 0), getattr(message, name)  # the field `off` needs quotes
        scalar = _scalar(value, indent, shown)
        if scalar is not None:
            lines.append(f"{margin}{key}: {scalar}")
        elif not _is_sequence(value):
            lines.append(f"{margin}{key}:")
            _write_fields(value, indent + 2, shown, lines)
        elif shown.no_arr:
            lines.append(f"{margin}{key}: {_string(abbreviation(slot, len(value)), indent)}")
        elif len(value) == 0:
            lines.append(f"{margin}{key}: []")
        else:
            lines.append(f"{margin}{key}:")
            _write_elements(value, indent, shown, lines)


def _write_elements(value: Any, indent: int, shown: Shown, lines: list[str]) -> None:
    margin = " " * indent
    kept, is_cut = _elements(value, shown)
    if isinstance(value, array) and value.typecode not in "fd":
        lines += [f"{margin}- {element}" for element in kept]
    else:
        for element in kept:
            scalar = _scalar(element, indent, shown)
            if scalar is not None:
                lines.append(f"{margin}- {scalar}")
            else:
                first = len(lines)
                _write_fields(element, indent + 2, shown, lines)
                lines[first] = f"{margin}- {lines[first][indent + 2 :]}"
    if is_cut:
        lines.append(f"{margin}- '{MORE}'")


def _scalar(value: Any, indent: int, shown: Shown) -> str | None:
    """A value that fits on the line of its name (or spills over, as only strings do); None for others."""
    if isinstance(value, float):
        return _float(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, (str, bytes)):
        return _string(_characters(value, shown), indent)
    return None if _is_sequence(value) or fields(type(value)) else "{}"


def _float(value: float) -> str:
    text = repr(value)
    if text[-1] in "fn":  # inf, nan
        return {"inf": ".inf", "-inf": "-.inf", "nan": ".nan"}[text]
    # YAML 1.1 wants a point in a number with an exponent.
    return text.replace("e", ".0e", 1) if "e" in text and "." not in text else text


@lru_cache(maxsize=512)
def _string(text: str, indent: int) -> str:
    if _PLAIN.fullmatch(text) and text.lower() not in _NOT_STRINGS:
        return text
    nested: Any = {"k": text}
    for _ in range(indent // 2):  # lines after the first are indented as deep as the field is nested
        nested = {"k": nested}
    return dump(nested, flow_style=False)[:-1].split("k: ", 1)[1]


def dump(data: Any, flow_style: bool) -> str:
    """Python data as YAML that ends with a newline, in block style; `flow_style` writes sequences in brackets."""
    text: str = yaml.dump(
        data, Dumper=_Dumper, allow_unicode=True, width=sys.maxsize, default_flow_style=flow_style, sort_keys=False
    )
    return text


class _FlowDumper(yaml.SafeDumper):
    """Strings with rare line breaks are always escaped, unlike in the real command: else they are read differently."""

    def represent_str(self, data: str) -> yaml.ScalarNode:
        style = '"' if _RARE_BREAKS.search(data) else None
        return self.represent_scalar("tag:yaml.org,2002:str", data, style)

    def ignore_aliases(self, data: Any) -> bool:
        return True


class _Dumper(_FlowDumper):
    """Writes mappings in block style even where sequences are in flow style, unless they are inside one."""

    def represent_dict(self, data: Mapping[str, Any]) -> yaml.MappingNode:
        pairs = [(self.represent_data(key), self.represent_data(value)) for key, value in data.items()]
        return yaml.MappingNode("tag:yaml.org,2002:map", pairs)


_FlowDumper.add_representer(str, _FlowDumper.represent_str)
_Dumper.add_representer(dict, _Dumper.represent_dict)


# Comma-separated values ------------------------------------------------------------------------------------------


def to_csv(message: Any, shown: Shown = EVERYTHING) -> str:
    """The values of a message and of all that it nests, separated by commas."""
    return _joined(_csv_value(getattr(message, name), slot, shown) for name, slot in fields(type(message)))


def _joined(values: Iterable[str]) -> str:
    """The values with commas between; as in the real command, none after empty ones at the beginning."""
    result = ""
    for value in values:
        result = f"{result},{value}" if result else value
    return result


def _csv_value(value: Any, slot: Any, shown: Shown) -> str:
    if isinstance(value, bytes):
        kept = value[: shown.truncate_length]
        return str(kept + MORE.encode() if len(kept) < len(value) else value)
    if isinstance(value, str):
        return _characters(value, shown)
    if isinstance(value, (bool, int, float)) or getattr(value, "shape", None) == ():  # numpy's numbers
        return str(value)
    if not _is_sequence(value):
        return to_csv(value, shown)
    if shown.no_arr and slot is not None:
        return abbreviation(slot, len(value))
    values = [_csv_value(element, None, shown) for element in value[: shown.truncate_length]]
    return _joined([*values, MORE] if len(values) < len(value) else values)
