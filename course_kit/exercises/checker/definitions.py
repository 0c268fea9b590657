"""Definitions of messages, services and actions, read as data: whether two say the same, in which order. Pure."""

from __future__ import annotations

import contextlib
import re
from typing import NamedTuple

CONSTANT = re.compile(r"(\S+)\s+([A-Za-z]\w*)\s*=\s*(\S.*)")
FIELD = re.compile(r"(\S+)\s+([A-Za-z]\w*)(?:\s+\S.*)?")  # with its default, which counts for whoever makes a message


class Line(NamedTuple):
    """A line of a definition."""

    counts: str  # type and name of a field, of a constant with the value, as a number if it is one
    code: str
    is_constant: bool


def is_as_asked(text: str, wanted: str) -> bool:
    """Return True if a definition has the wanted fields, in any order, and the wanted constants, or more of these."""
    return arranged(text, wanted) is not None


def arranged(text: str, wanted: str) -> str | None:
    """The wanted definition with its fields in the order of another one; None if that is not as asked.

    The three dashes of a service part its lines: the order counts across them.
    """
    parts, wanted_parts = _parts(text), _parts(wanted)
    if len(parts) != len(wanted_parts):
        return None
    result: list[str] = []
    for part, own in zip(parts, wanted_parts, strict=True):
        fields = [line.counts for line in part if not line.is_constant]
        own_fields = {line.counts: line.code for line in own if not line.is_constant}
        constants = [line for line in own if line.is_constant]
        missing = {line.counts for line in constants} - {line.counts for line in part if line.is_constant}
        if sorted(fields) != sorted(own_fields) or missing:
            return None
        result += ["---", *(line.code for line in constants), *(own_fields[field] for field in fields)]
    return "\n".join(result[1:]) + "\n"


def shown(text: str) -> str:
    """A definition in one line."""
    return " / ".join(" ".join(line.split()) for line in text.splitlines() if line.strip())


def _parts(text: str) -> list[list[Line]]:
    parts: list[list[Line]] = [[]]
    for line in text.splitlines():
        code = line.split("#")[0].strip()
        if code == "---":
            parts.append([])
        elif code:
            parts[-1].append(_line(code))
    return parts


def _line(code: str) -> Line:
    if constant := CONSTANT.fullmatch(code):
        value = constant[3]
        with contextlib.suppress(ValueError):
            value = str(float(value))
        return Line(f"{constant[1]} {constant[2]}={value}", code, True)
    field = FIELD.fullmatch(code)
    return Line(f"{field[1]} {field[2]}" if field else code, code, False)
