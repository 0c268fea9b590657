"""The templates that `ros2 pkg create` fills in.

`{{name}}` stands for a value; a line with a value that is a tuple comes once for each item. Lines with nothing but
`{{if name}}`, `{{else}}` and `{{end}}` choose.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

FOLDER = Path(__file__).with_name("templates")
LICENSES = FOLDER / "licenses"
Value = str | tuple[str, ...] | None
_CHOICE = re.compile(r"\{\{(if|else|end)(?: (\w+))?\}\}")
_PLACE = re.compile(r"\{\{(\w+)\}\}")


def filled(template: str, values: Mapping[str, Value]) -> str:
    """The text of a template file below `templates/`, named without its suffix."""
    return fill((FOLDER / f"{template}.template").read_text(encoding="utf-8"), values)


def fill(text: str, values: Mapping[str, Value]) -> str:
    """A template's text with the values in their places."""
    lines: list[str] = []
    shown = [True]  # for each `if` that is open: whether its lines are wanted
    for line in text.splitlines():
        choice = _CHOICE.fullmatch(line)
        if choice is None:
            lines += _lines(line, values) if all(shown) else []
        elif choice[1] == "if":
            shown.append(bool(values[choice[2]]))
        elif choice[1] == "else":
            shown[-1] = not shown[-1]
        else:
            shown.pop()
    return "".join(f"{line}\n" for line in lines)


def _lines(line: str, values: Mapping[str, Value]) -> list[str]:
    """A line of the template as the lines of the text that it stands for."""
    several = {name: value for name in _PLACE.findall(line) if isinstance(value := values[name], tuple)}
    if not several:
        return [_PLACE.sub(lambda place: str(values[place[1]]), line)]
    name, items = next(iter(several.items()))
    return [one for item in items for one in _lines(line, {**values, name: item})]
