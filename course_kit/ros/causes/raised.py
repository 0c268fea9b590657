"""An exception as the rules look at it."""

from __future__ import annotations

import difflib
import linecache
import re
from collections.abc import Callable, Iterable
from pathlib import Path
from types import FrameType
from typing import Any

from course_kit.ros.causes.frames import is_plumbing, line_of, steps


class Raised:
    """An error, where it was raised, and what stood there."""

    def __init__(self, error: BaseException) -> None:
        self.error = error
        self.kinds = {one.__name__ for one in type(error).__mro__}
        self.text = str(error)
        self.steps = list(steps(error.__traceback__))

    def fits(self, kinds: str, pattern: str) -> re.Match[str] | None:
        """The match of a pattern in the text, if the error is of one of these types: 'TypeError|ValueError'."""
        return re.search(pattern, self.text) if self.kinds & set(kinds.split("|")) else None

    @property
    def innermost(self) -> FrameType | None:
        """Where it was raised."""
        return self.steps[-1].tb_frame if self.steps else None

    @property
    def own(self) -> FrameType | None:
        """The student's frame that is nearest to where it was raised."""
        return next((s.tb_frame for s in reversed(self.steps) if not is_plumbing(Path(_file(s)))), None)

    @property
    def line(self) -> str:
        """The student's line that is nearest to where it was raised."""
        for step in reversed(self.steps):
            if not is_plumbing(Path(_file(step))):
                return linecache.getline(_file(step), line_of(step)).strip()
        return ""

    def went_through(self, function: str) -> FrameType | None:
        """The frame of a function of this name that it came through."""
        return next((s.tb_frame for s in self.steps if s.tb_frame.f_code.co_name == function), None)

    def named(self, name: str) -> Any:
        """What a name stands for in the student's code there, or None."""
        frame = self.own
        return None if frame is None else frame.f_locals.get(name, frame.f_globals.get(name))

    def instance(self, kind: str) -> Any:
        """The object that an AttributeError is about, as far as it can be found by the name of its class, or None.

        Python does not tell it where an attribute was set.
        """
        if (told := getattr(self.error, "obj", None)) is not None:
            return told
        values = [] if (frame := self.own) is None else list(frame.f_locals.values())
        if (found := next((one for one in values if type(one).__name__ == kind), None)) is not None:
            return found
        named = self.named(kind)
        return named() if isinstance(named, type) and fields(named) else None

    def names(self) -> set[str]:
        """The names that the student's code knows there."""
        return set() if (frame := self.own) is None else {*frame.f_locals, *frame.f_globals}


def _file(step: Any) -> str:
    return str(step.tb_frame.f_code.co_filename)


# Types of errors; a pattern of their text; the sentence, in which \1 is a group of it, or what makes it.
Sentence = str | Callable[[Raised, re.Match[str]], str]
Rule = tuple[str, str, Sentence]


def nearest(wanted: str, names: Iterable[str], cutoff: float = 0.6) -> str:
    """The one of the names that may have been meant, or ''."""
    return next(iter(difflib.get_close_matches(wanted, list(names), n=1, cutoff=cutoff)), "")


def enumerated(names: Iterable[str]) -> str:
    """Names as code, with commas."""
    return ", ".join(f"`{name}`" for name in names)


def a(word: str) -> str:
    """A word with its article."""
    return f"{'an' if word[:1] in tuple('aeiouAEIO') else 'a'} {word}"


def shown(value: Any) -> str:
    """A value and its type, or if it is long its type alone."""
    text, kind = repr(value), a(type(value).__name__)
    return f"{text}, {kind}" if len(text) < 40 else kind


def fields(interface: Any) -> list[str]:
    """The names of the fields of a message or of a class of messages; none of anything else."""
    told = getattr(interface, "get_fields_and_field_types", None)
    return list(told()) if callable(told) else []


def filled(interface: Any) -> str:
    """How a message of a class is written, with its first fields."""
    given = ", ".join(f"{field}=…" for field in fields(interface)[:2])
    return f"{interface.__name__}({given})"
