"""Fields of recorded messages as numpy arrays. Pure: works on message classes, imports no ROS."""

from __future__ import annotations

import difflib
import importlib
import re
import struct
from collections.abc import Iterable
from operator import attrgetter
from typing import Any

import numpy as np
import numpy.typing as npt

from course_kit.base.arguments import shown
from course_kit.lab.recordings.buffers import Serialised
from course_kit.ros.interface_types import steps, type_name

HEADER = 4  # bytes before the first field of a serialised message: encoding, options
NUMBERS = {"boolean": np.dtype(np.bool_), "uint64": np.dtype(np.uint64)}
NUMBERS |= {name: np.dtype(np.float64) for name in ("float", "double")}
NUMBERS |= {f"{sign}int{bits}": np.dtype(np.int64) for sign in ("", "u") for bits in (8, 16, 32)}
NUMBERS |= {name: np.dtype(np.int64) for name in ("int64", "octet", "char")}


def is_stamped(message_type: Any) -> bool:
    """Return True if the first field of a type is a std_msgs/Header or a time `stamp`."""
    first = next(iter(message_type.get_fields_and_field_types().items()), None)
    return first in (("header", "std_msgs/Header"), ("stamp", "builtin_interfaces/Time"))


def stamp_ns(message: bytes) -> int:
    """The stamp of one serialised message of a stamped type, in nanoseconds."""
    sec, nanosec = struct.unpack_from("<iI" if message[1] & 1 else ">iI", message, HEADER)
    return int(sec) * 1_000_000_000 + int(nanosec)


def stamps(serialised: Serialised, message_type: Any) -> npt.NDArray[np.float64] | None:
    """The stamps of messages whose first field is a std_msgs/Header or a time `stamp`; None for other types.

    Seconds as float64, shape (messages,), read from the bytes without decoding a message.
    """
    if not is_stamped(message_type):
        return None
    if not len(serialised):
        return np.empty(0)
    order = "<" if serialised[0][1] & 1 else ">"  # little or big endian
    time = np.dtype([("sec", f"{order}i4"), ("nanosec", f"{order}u4")])
    read = serialised.columns(HEADER, time.itemsize).view(time)[:, 0]
    return np.asarray(read["sec"] + read["nanosec"] * 1e-9, np.float64)


def values(messages: Iterable[Any], message_type: Any, path: str) -> npt.NDArray[Any]:
    """The numeric field `path` of every message: shape (messages,), or (messages, length) for an array field.

    Raises ValueError for a field that is not there, is no number, or whose length varies.
    """
    field_type = resolve(message_type, path)
    element = element_type(field_type)
    dtype = NUMBERS[element]
    read = attrgetter(path)
    if element == field_type:
        found = [read(message) for message in messages]
        if element == "octet":
            found = [value[0] for value in found]
        return np.array(found, dtype)
    rows = [np.asarray(read(message)) for message in messages]
    if len({len(row) for row in rows}) > 1:
        raise ValueError(
            f"{path} has not the same length in all messages: read it with [m.{path} for m in recording.messages]"
        )
    return np.array(rows, dtype) if rows else np.empty((0, 0), dtype)


def element_type(field_type: str) -> str:
    """The type of the elements of an array type, or the type itself: 'double' of 'sequence<double, 3>'."""
    field_type = re.sub(r"^sequence<(.*?)(, \d+)?>$", r"\1", field_type)
    return re.sub(r"\[\d+\]$", "", field_type)


def resolve(message_type: Any, path: str) -> str:
    """The type of a numeric field; ValueError says what is there if it is none."""
    current, kind = message_type, type_name(message_type)
    done: list[str] = []
    for name, _, _ in steps(path):
        fields = current.get_fields_and_field_types() if current is not None else {}
        if name not in fields:
            raise ValueError(_no_field(name, done, kind, fields))
        done.append(name)
        kind = fields[name]
        current = nested(kind)
    if current is not None:
        inside = list(current.get_fields_and_field_types())
        raise ValueError(
            f"{path} is a {kind} and not a number; it has the fields {', '.join(inside)}: write '{path}.{inside[0]}'"
        )
    if element_type(kind) not in NUMBERS:
        raise ValueError(f"{path} is a {kind} and not a number: read it with [m.{path} for m in recording.messages]")
    return kind


def _no_field(name: str, done: list[str], type_name: str, fields: dict[str, str]) -> str:
    where = f"{'.'.join(done)} ({type_name})" if done else type_name
    if not fields:
        return f"{where} has no fields, so there is no {shown(name)} in it"
    near = difflib.get_close_matches(name, fields, n=1)
    hint = f" Did you mean {near[0]!r}?" if near else ""
    return f"{where} has no field {shown(name)}; it has {', '.join(fields)}.{hint}"


def nested(type_name: str) -> Any:
    """The class of a nested message type such as 'geometry_msgs/Point', or None for anything else."""
    if not re.fullmatch(r"\w+/\w+", type_name):
        return None
    package, name = type_name.split("/")
    return getattr(importlib.import_module(f"{package}.msg"), name)
