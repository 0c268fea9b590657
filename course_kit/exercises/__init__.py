"""The exercises of the course: the modules of a chapter say what each asks and how it is checked.

A check is a function that reads like the exercise's text, in the vocabulary of course_kit/examining. It runs in the
checker, a process of its own. The modules are loaded when an exercise of theirs is asked for.
"""

from __future__ import annotations

import difflib
import importlib
import pkgutil

from course_kit.arguments import shown
from course_kit.examining.exercise import DECLARED, Exercise

# In the order of the course: {what names begin with, of the chapter's exercises and of their modules: its title}.
CHAPTERS = {
    "setup": "1 · Setup checks",
    "workspace": "2 · Workspace",
    "topics": "3 · Topics",
    "services": "4 · Services",
    "actions": "5 · Actions",
    "debugging": "6 · Debugging",
    "robot": "7 · A robot that finds its way",
}


def of_chapter(chapter: str) -> list[Exercise]:
    """The exercises of a chapter, in order."""
    for module in pkgutil.iter_modules(__path__):
        if module.name.startswith(chapter):
            importlib.import_module(f"{__name__}.{module.name}")
    declared = [exercise for exercise in DECLARED.values() if exercise.chapter == chapter]
    return sorted(declared, key=lambda exercise: int(exercise.name.rsplit("-", 1)[1]))


def every() -> list[Exercise]:
    """All exercises of the course, in order."""
    return [exercise for chapter in CHAPTERS for exercise in of_chapter(chapter)]


def find(name: str) -> Exercise:
    """The exercise of that name. ValueError if there is none, with what may have been meant."""
    chapter = name.rsplit("-", 1)[0]
    names = [exercise.name for exercise in (of_chapter(chapter) if chapter in CHAPTERS else every())]
    if name in names:
        return DECLARED[name]
    near = difflib.get_close_matches(name, names, n=1)
    hint = f"Did you mean {near[0]!r}?" if near else f"There are {', '.join(names)}."
    raise ValueError(f"there is no exercise {shown(name)}. {hint}")
