"""A cheat: an answer that wants points which it has not earned, or to do harm, and what must come of it."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field

from tests.exercises.chapter import Wrong, answers_to
from tests.grading.handed_in import references

# Where these stand in an answer, the test puts a file of this machine, and a port at which it listens.
CANARY, PORT = "@CANARY@", "@PORT@"
ESCAPED = "ESCAPED"  # what an answer prints that has got at something
LEFT_BEHIND = (
    f"course-cheat-left-behind-{os.getpid()}"  # in the command line of processes that want to outlive the grading
)
EMPTY = """
class Lamp(Node):
    def __init__(self):
        super().__init__("lamp")
"""
NO_GREETER = "class Greeter(Node):\n    pass\n"
WRONG_REPORT = 'domain, discovery_range = 99, "SUBNET"\n'


@dataclass(frozen=True)
class Cheat:
    """What is in an answer cell, and the points that it must get."""

    name: str
    exercise: str
    tries: str  # to do what, in a sentence
    source: str
    points: int = 0
    honest: str = ""  # another exercise of the chapter, whose right answer must keep all its points
    says: str = ""  # what the answer's cell must have printed: the cheat was tried indeed
    workspace: Mapping[str, str] = field(default_factory=dict)  # that is handed in with it, by path below src
    timeout: float = 20.0  # of a cell
    by_default: bool = False  # whether it is run without --full
    seconds: int = 300  # after which the test has hung
    mostly_waits: bool = False  # for a time-out, or a process that has ended: two thirds of its grading


def wrong(exercise: str, name: str) -> Wrong:
    """A wrong answer of those that the exercises are tested with."""
    answers = next(a for a in answers_to(exercise.rpartition("-")[0]) if a.exercise == exercise)
    return next(answer for answer in answers.wrong if answer.name == name)


def reference(exercise: str) -> str:
    """The right answer to an exercise, which runs by itself."""
    return references(exercise.rpartition("-")[0])[exercise]
