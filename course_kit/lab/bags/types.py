"""The full definition and the hash of a message type, which a bag keeps, from the ament index."""

from __future__ import annotations

import json
from pathlib import Path

from rosidl_adapter.parser import parse_message_string  # type: ignore[import-untyped]

from course_kit.ros.interface_types import nested_types
from course_kit.ros.packages import share_directory

SEPARATOR = "=" * 80


def definition(type_name: str) -> str:
    """The text of a type's .msg file, followed by those of all types it is made of; '' where there is no such file."""
    texts: dict[str, str] = {}
    waiting = [_short(type_name)]
    while waiting:
        name = waiting.pop(0)
        if name in texts:
            continue
        try:
            texts[name] = _file(name, "msg", ".msg").read_text(encoding="utf-8")
        except (OSError, LookupError):
            return ""
        parsed = parse_message_string(*name.split("/"), texts[name])
        waiting += map(_short, nested_types(parsed))
    (_, first), *others = texts.items()
    return "".join([first, *(f"\n{SEPARATOR}\nMSG: {name}\n{text}" for name, text in others)])


def type_hash(type_name: str, part: str = "") -> str:
    """The hash (RIHS01_…) of a type, or of a `part` of it such as _Request; '' if its package does not tell it."""
    try:
        described = json.loads(_file(type_name, type_name.split("/")[1], ".json").read_text(encoding="utf-8"))
    except (OSError, ValueError, LookupError):
        return ""
    hashes = {entry.get("type_name"): entry.get("hash_string") for entry in described.get("type_hashes", ())}
    return str(hashes.get(type_name + part) or "")


def _short(type_name: str) -> str:
    """'std_msgs/String' for 'std_msgs/msg/String': the form in which definitions name types."""
    return type_name.replace("/msg/", "/")


def _file(type_name: str, folder: str, ending: str) -> Path:
    package, name = type_name.split("/")[0], type_name.rsplit("/", 1)[-1]
    return Path(share_directory(package), folder, name + ending)
