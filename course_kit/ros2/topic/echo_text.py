"""What `ros2 topic echo` prints of a message: a field of it, YAML or values with commas, what is said about losses."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from course_kit.interface_types import steps
from course_kit.ros2.messages.yaml_text import Shown, to_csv, to_yaml
from course_kit.ros2.verbs import CommandError


def selector(path: str | None) -> Callable[[Any], Any]:
    """What picks the field of a message that a path such as 'poses[0].position' names. Its errors: CommandError."""
    if path is None:
        return lambda message: message
    names = [name for name in path.split(".") if name]
    if not names:
        raise CommandError(f"Invalid field value '{path}'")
    chosen: list[str | int] = []
    for step in steps(".".join(names)):
        chosen += [step.name, *step.indexes]

    def select(message: Any) -> Any:
        for step in chosen:
            try:
                message = message[step] if isinstance(step, int) else getattr(message, step)
            except (AttributeError, IndexError, TypeError, KeyError) as error:
                raise CommandError(f"Invalid field '{'.'.join(names)}': {error}") from None
        return message

    return select


def expression(text: str) -> Callable[[Any], Any]:
    """The filter that a Python expression of `m` stands for. Its errors: CommandError."""
    try:
        code = compile(text, "<filter>", "eval")
    except (SyntaxError, ValueError) as error:
        reason = error.msg if isinstance(error, SyntaxError) else error
        raise CommandError(f"Invalid filter expression '{text}': {reason}") from None

    def matches(message: Any) -> Any:
        try:
            return eval(code, {"m": message})
        except Exception as error:  # whatever the user's expression does
            reason = " ".join(str(error).split()) or type(error).__name__
            raise CommandError(f"Invalid filter expression '{text}': {reason}") from None

    return matches


def message_text(
    message: Any, info: dict[str, Any] | None, shown: Shown, csv: bool = False, flow_style: bool = False
) -> str:
    """What echo prints for a message, or for a field of one; with `info` also about its way here."""
    if not hasattr(message, "__slots__") or not hasattr(message, "get_fields_and_field_types"):
        about = f"---Got new message, message info:---\n{info}\n---Message data:---\n" if info is not None else ""
        return f"{about}{message}\n---\n"
    if csv:
        about = "".join(f"{value}," for value in info.values()) if info is not None else ""
        return f"{about}{to_csv(message, shown)}\n"
    about = ""
    if info is not None:
        import yaml

        about = f"{yaml.safe_dump(info)}---\n"
    return f"{about}{to_yaml(message, shown, flow_style)}---\n"


def lost_text(change: int, total: int) -> str:
    """What echo says when messages were lost."""
    return f"A message was lost!!!\n\ttotal count change:{change}\n\ttotal count: {total}---\n"
