"""Rules for the arguments of public functions: one that does not fit is refused before anything happens.

@takes(timeout=WAIT, title=TEXT | None)
def function(...): ...
"""

from __future__ import annotations

import functools
import inspect
import numbers
import os
import re
import reprlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")

LONGEST = 1e8  # seconds, three years: the system's clocks wait for no longer
MOST = 10**12
_shortened = reprlib.Repr()
_shortened.maxstring = _shortened.maxother = 100  # letters
NODE_NAME = re.compile(r"/|/?[A-Za-z_]\w*(/[A-Za-z_]\w*)*/?", re.ASCII)


@dataclass(frozen=True)
class Rule:
    """What one argument may be."""

    what: str  # ends the sentence "… must be"
    example: str
    types: tuple[type, ...]
    fits: Callable[[Any], bool]

    def __or__(self, _: None) -> Rule:
        """The same, or None."""
        return replace(self, what=f"{self.what}, or None", types=(*self.types, type(None)), fits=_or_none(self.fits))

    def _is_kind(self, value: Any) -> bool:
        return isinstance(value, self.types) and not isinstance(value, bool)

    def accepts(self, value: Any) -> bool:
        """Return True if it is of the right kind and makes sense."""
        return self._is_kind(value) and self.fits(value)

    def check(self, name: str, value: Any) -> None:
        """Raise TypeError for a value of another kind, ValueError for one that makes no sense."""
        if self.accepts(value):
            return
        problem = ValueError if self._is_kind(value) else TypeError
        raise problem(f"{name} must be {self.what}, not {shown(value)}. Write it like {self.example}")


def _or_none(fits: Callable[[Any], bool]) -> Callable[[Any], bool]:
    return lambda value: value is None or fits(value)


def shown(value: Any) -> str:
    """A value as it may stand in a sentence: short, on one line, and printable."""
    return " ".join(_shortened.repr(value).split())


def is_text(value: str) -> bool:
    """Return True if a text can be printed and sent: no half of a surrogate pair, no NUL."""
    return "\0" not in value and not any("\ud800" <= letter <= "\udfff" for letter in value)


def is_known_to_system(value: Any) -> bool:
    """Return True if a text can be a name, a word or a value for the system: bytes without a zero."""
    try:
        return isinstance(value, str) and b"\0" not in os.fsencode(value)
    except UnicodeEncodeError:
        return False


def is_path(value: str | os.PathLike[str]) -> bool:
    """Return True if the system can have a file of this name."""
    name = os.fspath(value)
    return is_known_to_system(name) and bool(name.strip())


def is_command(value: str | Sequence[Any]) -> bool:
    """Return True if the system can be given these words."""
    return all(map(is_known_to_system, [value] if isinstance(value, str) else map(str, value)))


def is_environment(value: Mapping[Any, Any]) -> bool:
    """Return True if these can be environment variables."""
    return all(map(is_known_to_system, (*value, *value.values()))) and not any(
        "=" in name or not name for name in value
    )


# What is left until a deadline may be below 0, and is then no time.
WAIT = Rule("a time in seconds", "5.0", (numbers.Real,), lambda value: -LONGEST <= value <= LONGEST)
SPAN = Rule("a span of time in seconds, more than 0", "2.0", (numbers.Real,), lambda value: 0 < value <= LONGEST)
COUNT = Rule("a whole number, 1 or more", "10", (numbers.Integral,), lambda value: 1 <= value <= MOST)
SIGNAL = Rule("a signal's number", "signal.SIGINT", (numbers.Integral,), lambda value: 1 <= value <= 64)
RATE = Rule("how many times as fast, more than 0", "1.0", (numbers.Real,), lambda value: 0 < value <= MOST)
DISTANCE = Rule("a distance, 0 or more", "1e-6", (numbers.Real,), lambda value: value >= 0)
TEXT = Rule("a text", "'text'", (str,), is_text)
PATH = Rule("the path of a file or folder", "'drive'", (str, os.PathLike), is_path)
COMMAND = Rule("a command or a list of its words", "'ros2 node list'", (str, list, tuple), is_command)
ENVIRONMENT = Rule("variables with their values", "{'ROS_DOMAIN_ID': '7'}", (Mapping,), is_environment)
METRES = Rule("a number of metres", "8.0", (numbers.Real,), lambda value: -LONGEST <= value <= LONGEST)
PLACES = Rule("a list of places in metres", "[(8.0, 3.0)]", (list, tuple), lambda value: all(map(is_place, value)))
NODE = Rule("the name of a node", "'/turtlesim'", (str,), lambda value: bool(NODE_NAME.fullmatch(value)))
NAMESPACE = replace(NODE, what="a namespace", example="'/robot1'", fits=lambda value: not value or NODE.fits(value))


def is_place(value: Any) -> bool:
    """Return True if it is x and y, two numbers of metres."""
    return isinstance(value, tuple | list) and len(value) == 2 and all(map(METRES.accepts, value))


def takes(**rules: Rule) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Have the named arguments of a function looked at; of *arguments each."""

    def checking(function: Callable[P, R]) -> Callable[P, R]:
        signature = inspect.signature(function)
        several = {name for name, one in signature.parameters.items() if one.kind is one.VAR_POSITIONAL}

        @functools.wraps(function)
        def checked(*args: P.args, **kwargs: P.kwargs) -> R:
            given = signature.bind(*args, **kwargs).arguments
            for name, rule in rules.items():
                for value in given.get(name, ()) if name in several else [given[name]] if name in given else []:
                    rule.check(f"{function.__name__}(): {name}", value)
            return function(*args, **kwargs)

        return checked

    return checking
