"""The output of `ros2 topic echo`: a field of a message, YAML or values with commas, lost messages."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import yaml

from course_kit.cli.ros2.messages.yaml_text import Shown, to_csv, to_yaml
from course_kit.cli.ros2.verbs import CommandError, failing, one_line
from course_kit.ros.interface_types import steps


def selector(path: str | None) -> Callable[[Any], Any]:
    """What picks the field of a message that a path such as 'poses[0].position' names. Its errors: CommandError."""
    if path is None:
        return lambda message: message
    names = [name for name in path.split(".") if name]
    if not names:
        raise CommandError(f"Invalid field value '{path}'")
    field = ".".join(names)
    parts = [part for step in steps(field) for part in (step.name, *step.indexes)]
    chosen: list[Any] = [part for part in parts if part != ""]  # 'ranges.[0]' is as good

    def select(message: Any) -> Any:
        with failing(
            AttributeError, IndexError, TypeError, KeyError, say=lambda error: f"Invalid field '{field}': {error}"
        ):
            for part in chosen:
                message = message[part] if isinstance(part, int) else getattr(message, part)
        return message

    return select


def expression(text: str) -> Callable[[Any], Any]:
    """The filter that a Python expression of `m` stands for. Its errors: CommandError."""

    def say(error: Exception) -> str:
        return f"Invalid filter expression '{text}': {getattr(error, 'msg', None) or one_line(error)}"

    with failing(SyntaxError, ValueError, RecursionError, MemoryError, say=say):  # the last two if it nests deep
        code = compile(text, "<filter>", "eval")

    def matches(message: Any) -> Any:
        with failing(Exception, say=say):  # whatever the user's expression does
            return eval(code, {"m": message})

    return matches


def message_text(
    message: Any, info: dict[str, Any] | None, shown: Shown, csv: bool = False, flow_style: bool = False
) -> str:
    """What echo prints for a message, or for a field of one; with `info` also about its way here."""
    if not hasattr(message, "__slots__") or not hasattr(message, "get_fields_and_field_types"):
        about = f"---Got new message, message info:---\n{info}\n---Message data:---\n" if info is not None else ""
        return f"{about}{message}\n---\n"
    if csv:
        return ",".join([*map(str, (info or {}).values()), to_csv(message, shown)]) + "\n"
    about = "" if info is None else f"{yaml.safe_dump(info)}---\n"
    return f"{about}{to_yaml(message, shown, flow_style)}---\n"


def lost_text(change: int, total: int) -> str:
    """What echo says when messages were lost."""
    return f"A message was lost!!!\n\ttotal count change:{change}\n\ttotal count: {total}---\n"
