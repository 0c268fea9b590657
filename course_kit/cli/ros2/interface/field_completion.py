"""Tab inside the YAML of a message that is being typed: fields, first values, brackets.

From the definitions, as the Python classes of most packages import NumPy, which takes longer than all else.

Of several texts a shell inserts what all begin with, and a single one it closes with the quote. So a field that alone
fits is offered twice, the second time with the value that it has in a new message.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import takewhile
from typing import Any

import yaml
from rosidl_adapter.parser import parse_message_string  # type: ignore[import-untyped]

from course_kit.cli.ros2.interface.text import SEPARATOR

_FIRST = {"bool": "false", "float32": "0.0", "float64": "0.0", "string": '""', "wstring": '""'}
_NOW = {"builtin_interfaces/Time": ["now"], "std_msgs/Header": ["auto"]}  # what may stand for all fields
_STARTS = (yaml.FlowMappingStartToken, yaml.FlowSequenceStartToken)
_ENDS = (yaml.FlowMappingEndToken, yaml.FlowSequenceEndToken)


class Fillable:
    """What a caller fills in: the fields of a message, of a service's request, of an action's goal."""

    def __init__(self, type_name: str, read: Callable[[str], str]) -> None:
        """`read(type name)` gives the text of a definition, and its errors pass through."""
        package, _, name = type_name.split("/")
        lines = takewhile(lambda line: line.rstrip() != SEPARATOR, read(type_name).splitlines())
        parsed = parse_message_string(package, name, "\n".join(lines))
        self._read, self.fields = read, {one.name: one for one in parsed.fields}

    def of(self, slot: Any) -> Fillable:
        """The message that a field is, or its elements are."""
        return Fillable(f"{slot.pkg_name}/msg/{slot.type}", self._read)

    def prototype(self) -> str:
        """All fields with what they hold in a new message, on one line."""
        return f"{{{', '.join(f'{name}: {self.first(name)}' for name in self.fields)}}}"

    def first(self, name: str) -> str:
        """What a field holds in a new message."""
        slot, default = self.fields[name].type, self.fields[name].default_value
        if default is not None:
            return json.dumps(default, ensure_ascii=False)
        if not slot.is_array:
            return self.first_of(slot)
        count = slot.array_size if slot.array_size and not slot.is_upper_bound else 0
        return f"[{', '.join([self.first_of(slot)] * count)}]" if count else "[]"

    def first_of(self, slot: Any) -> str:
        """What a field or an element of a type is at first."""
        return _FIRST.get(slot.type, "0") if slot.is_primitive_type() else self.of(slot).prototype()

    def names(self, seen: Sequence[str] = (), typed: str = "") -> list[str]:
        """The fields that are not there yet and begin as typed; a single one also with its first value."""
        left = [name for name in self.fields if name not in seen and name.startswith(typed)]
        first = [self.first(left[0])] if len(left) == 1 else []
        return [f"{name}: {value}" for name in left for value in ("", *first)]


def continuations(root: Fillable, begun: str) -> list[str]:
    """What may stand in place of the YAML that is begun, on one line."""
    try:
        return _Place(root, begun).offers()
    except (yaml.YAMLError, LookupError, ValueError):  # inside quotes; of another style, or of no such type
        return []


@dataclass
class _Bracket:
    """A bracket that is open: of a message with the fields that are there, or of a sequence."""

    message: Fillable
    element: Any = None  # the type of a sequence in the message
    seen: list[str] = field(default_factory=list)
    awaits_value: bool = False
    is_filled: bool = False  # by the value that was awaited
    is_implied: bool = False  # as in 'data: hello', which has none

    @property
    def slot(self) -> Any:
        """The type of the value that is awaited, or has come."""
        return self.element or self.message.fields[self.seen[-1]].type

    @property
    def is_of_sequence(self) -> bool:
        """True if the value is, or was, a sequence."""
        return not self.element and bool(self.slot.is_array)

    def values(self) -> list[str]:
        """How the value may begin, and what it may be."""
        slot = self.slot
        if self.is_of_sequence:
            return ["[", *self._with_end(self.message.first(self.seen[-1]))]
        if not slot.is_primitive_type():
            now = _NOW.get(f"{slot.pkg_name}/{slot.type}", [])
            return [*now, *(f"{{{text}" for text in self.message.of(slot).names())]
        if slot.type == "bool":
            return [*self._with_end("false"), *self._with_end("true")]
        return self._with_end(_FIRST.get(slot.type, "0") if self.element else self.message.first(self.seen[-1]))

    def _with_end(self, value: str) -> list[str]:
        return [value + end for end in ("", *self.ends()[:1])]

    def ends(self) -> list[str]:
        """What may follow a value."""
        if self.is_implied:
            return []
        if self.element:
            return [", ", "]"]
        return [*(f", {name}: " for name in self.message.fields if name not in self.seen), "}"]


class _Place:
    """Where a text that is begun ends: in which brackets, and with which word."""

    def __init__(self, root: Fillable, begun: str) -> None:
        self._root, self._begun, self._typed = root, begun, ""
        self._open: list[_Bracket] = []
        self._is_over = is_name = False
        for token in yaml.scan(begun):
            if isinstance(token, (yaml.StreamEndToken, yaml.BlockEndToken)):
                return
            self._typed = ""
            if isinstance(token, _STARTS):
                self._enter(isinstance(token, yaml.FlowSequenceStartToken))
            elif isinstance(token, _ENDS):
                self._leave()
            elif isinstance(token, yaml.ScalarToken):
                self._read(token, is_name)
            elif isinstance(token, yaml.ValueToken):
                self._open[-1].awaits_value = True
            elif isinstance(token, yaml.FlowEntryToken):
                bracket = self._open[-1]
                bracket.awaits_value, bracket.is_filled = bracket.element is not None, False
            elif isinstance(token, yaml.BlockMappingStartToken) and not self._open:
                self._open.append(_Bracket(root, is_implied=True))
            elif not isinstance(token, (yaml.StreamStartToken, yaml.KeyToken)):
                raise LookupError
            is_name = isinstance(token, yaml.KeyToken)

    def _enter(self, is_sequence: bool) -> None:
        outer = self._open[-1] if self._open else None
        if self._is_over or is_sequence != (outer is not None and outer.is_of_sequence):
            raise LookupError
        if outer is None:
            self._open.append(_Bracket(self._root))
        elif is_sequence:
            self._open.append(_Bracket(outer.message, outer.slot, awaits_value=True))
        else:
            self._open.append(_Bracket(outer.message.of(outer.slot)))

    def _leave(self) -> None:
        self._open.pop()
        self._is_over = not self._open
        if self._open:
            self._open[-1].is_filled = True

    def _read(self, token: Any, is_name: bool) -> None:
        """Note a scalar: a field's name, a value, or what may become one of them."""
        if is_name:
            self._open[-1].seen.append(token.value)
        else:
            self._typed = self._begun[token.start_mark.index :]

    def offers(self) -> list[str]:
        """What may follow."""
        begun, typed = self._begun, self._typed
        head = begun.removesuffix(typed)
        head += " " if head[-1:] in (":", ",") else ""
        if not self._open:
            brace = "" if typed else "{"
            return [] if self._is_over else [head + brace + text for text in self._root.names((), typed)]
        bracket = self._open[-1]
        if not bracket.awaits_value:
            return [head + text for text in bracket.message.names(bracket.seen, typed)]
        values = [] if bracket.is_filled else [head + text for text in bracket.values()]
        offered = [text for text in values if text.startswith(begun) and text != begun]
        return offered or [begun + text for text in bracket.ends()]
