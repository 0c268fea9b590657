"""A message on a command line, checked: its type, the name it goes to, its values as YAML."""

from __future__ import annotations

import contextlib
import importlib
import sys
from argparse import Namespace
from typing import Any

from course_kit.cli.ros2.messages.values import NotYaml, parse, populate
from course_kit.cli.ros2.verbs import CommandError, did_you_mean, failing
from course_kit.ros.private_api.import_parts import arrays_later

_PARTS = {
    "msg": ("get_fields_and_field_types",),
    "srv": ("Request", "Response"),
    "action": ("Goal", "Result", "Feedback"),
}
LONGEST_NAME = 255 - 8  # characters, as rmw has it
_ACTION_PART = "/_action/cancel_goal"  # the longest that rcl appends to an action's name
_NOUNS = {"msg": "message", "srv": "service", "action": "action"}


def interface_class(name: str, kind: str) -> Any:
    """The class of a type such as 'std_msgs/msg/String' or 'std_msgs/String'; `kind` is msg, srv or action.

    Raises CommandError for a type that is not installed, is misspelt or is of another kind.
    """
    parts = name.split("/")
    if len(parts) == 2:
        parts.insert(1, kind)
    found = None
    if len(parts) == 3 and parts[1] in _PARTS and all(part.isidentifier() for part in parts):
        with arrays_later(), contextlib.suppress(ImportError):
            found = getattr(importlib.import_module(f"{parts[0]}.{parts[1]}"), parts[2], None)
    is_type = isinstance(found, type)
    if is_type and parts[1] == kind and all(hasattr(found, part) for part in _PARTS[kind]):
        return found
    if is_type and kind == "srv":
        raise CommandError("The passed type is not a service")

    from course_kit.cli.ros2.interface.interface import types

    raise CommandError(f"The passed {_NOUNS[kind]} type is invalid", did_you_mean("/".join(parts), types([kind])))


def checked_name(name: str, noun: str) -> str:
    """The name of a service or an action as it was given. Raises CommandError for what cannot be one."""
    from rclpy.exceptions import InvalidTopicNameException
    from rclpy.validate_topic_name import validate_topic_name

    def say(error: Exception) -> str:
        reason = str(error).split("\n")[0].rstrip(":").partition(": topic name ")[2]
        return f"Invalid {noun} name '{name}': it {reason}"

    with failing(InvalidTopicNameException, say=say):
        validate_topic_name(name)
    longest = LONGEST_NAME - (len(_ACTION_PART) if noun == "action" else 0)
    if len(name) > longest:
        raise CommandError(f"Invalid {noun} name '{name}': it is longer than {longest} characters")
    return name


def checked_node_name(name: str) -> str:
    """The name of a node as it was given. Raises CommandError for what cannot be one."""
    from rclpy.exceptions import InvalidNodeNameException
    from rclpy.validate_node_name import validate_node_name

    with failing(InvalidNodeNameException, say=lambda error: str(error).split("\n")[0].rstrip(":")):
        validate_node_name(name)
    return name


def parsed(args: Namespace, text: str, refusal: str = "The passed value is not valid YAML: {}") -> Any:
    """What a YAML text stands for: `text`, or standard input if --stdin is given. CommandError if it is none."""
    with failing(NotYaml, say=refusal.format):
        return parse(sys.stdin.buffer.read() if args.stdin else text)


def filled(message: Any, values: Any, refusal: str = "Failed to populate field: {}") -> list[Any]:
    """Set a message's fields as populate() does and return its times. CommandError for values that do not fit."""
    with failing(AttributeError, TypeError, ValueError, OverflowError, AssertionError, say=refusal.format):
        return populate(message, values)
