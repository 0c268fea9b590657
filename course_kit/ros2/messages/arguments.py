"""Messages that a command line gives as YAML."""

from __future__ import annotations

import sys
from argparse import Namespace
from typing import Any

from course_kit.ros2.messages.values import NotYaml, parse, populate
from course_kit.ros2.verbs import CommandError


def parsed(args: Namespace, text: str, refusal: str = "The passed value is not valid YAML: {}") -> Any:
    """What a YAML text stands for: `text`, or standard input if --stdin is given. CommandError if it is none."""
    try:
        return parse(sys.stdin.buffer.read() if args.stdin else text)
    except NotYaml as error:
        raise CommandError(refusal.format(error)) from None


def filled(message: Any, values: Any, refusal: str = "Failed to populate field: {}") -> list[Any]:
    """Set a message's fields as populate() does and return its times. CommandError for values that do not fit."""
    try:
        return populate(message, values)
    except (AttributeError, TypeError, ValueError, OverflowError, AssertionError) as error:
        raise CommandError(refusal.format(error)) from None
