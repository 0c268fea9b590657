"""The exercises of the course: one module a chapter says what each asks and how it is checked.

A check is a function that reads like the exercise's text, in the vocabulary of course_kit/checking. It runs in the
checker, a process of its own. The modules are loaded when an exercise of theirs is asked for.
"""

from __future__ import annotations

import difflib
import importlib
from collections.abc import Callable
from dataclasses import dataclass

# Which modules there are, in the order of the course: {what an exercise's name begins with: chapter's title}.
CHAPTERS = {
    "setup": "1 · Setup checks",
    "workspace": "2 · Workspace",
    "topics": "3 · Topics",
    "services": "4 · Services",
    "actions": "5 · Actions",
    "debugging": "6 · Debugging",
}
# Where the module is not called as the exercises are, or there is more than one.
MODULES = {
    "setup": ("setup_checks",),
    "workspace": ("workspace", "workspace_patrol"),
    "actions": ("actions", "actions_star"),
    "debugging": ("debugging", "debugging_mileage", "debugging_monitor"),
}
LEVELS = ("warm-up", "medium", "harder", "project")


@dataclass(frozen=True)
class Exercise:
    """One exercise, and the function that checks it."""

    name: str  # such as "topics-1"
    title: str
    points: int
    minutes: int
    level: str
    timeout: float  # seconds that a check takes at most
    node_class: str | None  # the class that the student writes, if it asks for one
    node: str | None  # the full name of the student's node, if it asks for one
    file: str | None  # a file below ros2_ws/src that the student writes, if it asks for one
    types: tuple[str, ...]  # packages of types that the checker compiles for itself, once
    watches: tuple[str, ...]  # topics of the student's domain that are listened to from the chapter's first check on
    value: bool  # whether the answer is a value, handed to check()
    check: Callable[..., None]

    @property
    def chapter(self) -> str:
        return self.name.rsplit("-", 1)[0]


_exercises: dict[str, Exercise] = {}


def exercise(
    name: str,
    title: str,
    *,
    points: int,
    minutes: int,
    level: str,
    timeout: float = 15.0,
    node_class: str | None = None,
    node: str | None = None,
    file: str | None = None,
    types: tuple[str, ...] = (),
    watches: tuple[str, ...] = (),
    value: bool = False,
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Declare the function below as the check of an exercise; with `value` it is given the student's value."""
    if level not in LEVELS:
        raise ValueError(f"{name}: there is no level {level!r}, only {', '.join(LEVELS)}")
    if not (node_class or node or file or value):
        raise ValueError(f"{name}: say by `node_class`, `node`, `file` or `value` how to know that it was begun")

    def declare(check: Callable[..., None]) -> Callable[..., None]:
        _exercises[name] = Exercise(
            name, title, points, minutes, level, timeout, node_class, node, file, types, watches, value, check
        )
        return check

    return declare


def of_chapter(chapter: str) -> list[Exercise]:
    """The exercises of a chapter, in order."""
    for module in MODULES.get(chapter, (chapter,)):
        importlib.import_module(f"{__name__}.{module}")
    found = [one for one in _exercises.values() if one.chapter == chapter]
    return sorted(found, key=lambda one: int(one.name.rsplit("-", 1)[1]))


def every() -> list[Exercise]:
    """All exercises of the course, in order."""
    return [one for chapter in CHAPTERS for one in of_chapter(chapter)]


def find(name: str) -> Exercise:
    """The exercise of that name. ValueError if there is none, with what may have been meant."""
    chapter = name.rsplit("-", 1)[0]
    names = [one.name for one in (of_chapter(chapter) if chapter in CHAPTERS else every())]
    if name in names:
        return _exercises[name]
    near = difflib.get_close_matches(name, names, n=1)
    hint = f"Did you mean {near[0]!r}?" if near else f"There are {', '.join(names)}."
    raise ValueError(f"there is no exercise {name!r}. {hint}")
