"""The checks of a chapter: functions that judge an answer, each declared as the check of an exercise."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from course_kit import exercises
from course_kit.exercises.exercise import Exercise


@dataclass(frozen=True)
class Check:
    """The check of one exercise."""

    judge: Callable[..., None]  # takes the student's value where the exercise asks for one
    # The topics of the student's domain that are recorded from the chapter's first check on, and their types.
    watches: Mapping[str, Any] = field(default_factory=dict)


_declared: dict[str, Check] = {}  # by the name of the exercise, as far as the modules of the chapters are loaded


def check_of(exercise: str, **options: Any) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Declare a function as the check of an exercise, such as `@check_of("topics-1")`; `options` are those of Check."""

    def declare(judge: Callable[..., None]) -> Callable[..., None]:
        _declared[exercise] = Check(judge, **options)
        return judge

    return declare


def of_chapter(chapter: str) -> list[Check]:
    """Return the checks of a chapter, whose modules are loaded for that."""
    folders = [f"{folder}/{chapter}" for folder in exercises.__path__]
    for module in pkgutil.iter_modules(folders, f"{exercises.__name__}.{chapter}."):
        importlib.import_module(module.name)
    return [check for name, check in _declared.items() if name.rpartition("-")[0] == chapter]


def find(exercise: Exercise) -> Check:
    """Return the check of an exercise."""
    of_chapter(exercise.chapter)
    return _declared[exercise.name]
