"""check() in a notebook: asks the checker, shows what it found, keeps the points and counts the tries."""

from __future__ import annotations

import contextlib
import os
import re
import sys
from dataclasses import replace
from typing import Any

from course_kit.base import kernel
from course_kit.exercises.catalogue import CHAPTERS
from course_kit.exercises.in_notebook import checker_client, progress
from course_kit.exercises.protocol.channel import as_json
from course_kit.exercises.protocol.verdict import GRADED, NOT_BEGUN, Verdict
from course_kit.exercises.solutions import worked
from course_kit.ros.spinning import context

STRICT = "COURSE_KIT_STRICT"
NOTEBOOK = "JPY_SESSION_NAME"  # where Jupyter's server tells a kernel which notebook it was started for
_points_only = False
_last_asked = ""  # the exercise that was checked last in this kernel


def check(exercise: str, value: Any = None, seed: int | None = None) -> None:
    """Check your answer to an exercise, such as `check("topics-1")`, and show what was found.

    `value` is your answer where the exercise asks for a value. Nothing of yours is changed: nodes that run go on.
    A check draws the numbers, orders and moments that it tries; `seed`, as a verdict has it, has it draw the same
    again. The points of such a repetition are not kept.
    With COURSE_KIT_STRICT=1 in the environment, an answer that is begun and not all right raises AssertionError.
    """
    global _last_asked
    try:
        verdict = checker_client.ask(exercise, as_json(value), names(), seed)
    except Exception as error:  # a check never breaks a student's notebook
        is_refused = isinstance(error, checker_client.Refused | TypeError)
        print(f"check: {error}" if is_refused else f"check: {exercise} could not be checked: {error}")
        _be_strict(str(error))
        return
    _last_asked = exercise
    if _points_only or verdict.state == GRADED:
        print(verdict.heading)
        return
    notice = ""
    try:
        notice = progress.record(verdict) if seed is None else ""
    except OSError as error:
        notice = f"your points could not be kept: {error}"
    show(replace(verdict, further=_further(verdict)))
    for said in (notice, context.elsewhere()):
        if said:
            print(f"check: {said}")
    if verdict.state != NOT_BEGUN and not verdict.is_full:
        _be_strict(str(verdict))


def show_points_only() -> None:
    """Have checks show nothing that varies from one to the next, as in a notebook that a grader has rebuilt."""
    global _points_only
    _points_only = True


def _be_strict(reason: str) -> None:
    if os.environ.get(STRICT) == "1":
        raise AssertionError(reason)


def _further(verdict: Verdict) -> str:
    """Where the student may read on: in the solution, once it is open."""
    if verdict.state == NOT_BEGUN or not worked.is_there(verdict.exercise):
        return ""
    with contextlib.suppress(progress.Damaged):
        if progress.tries_left(verdict.exercise, verdict.max_points) == 0:
            what = "how the course solves it" if verdict.is_full else "a worked solution and what differs in yours"
            return f'`solution("{verdict.exercise}")` shows {what}.'
    return ""


def names() -> dict[str, Any]:
    """The variables of the notebook, or of the program that was started."""
    running = kernel.shell()
    return running.user_ns if running is not None else vars(sys.modules["__main__"])


def show(what: Any) -> None:
    """Show something below the cell; where there is no notebook, its text."""
    if kernel.shell() is not None:
        from IPython.display import display

        display(what)
    else:
        print(what)


def _chapter_at_hand() -> str:
    """The chapter whose notebook this is, else the one whose exercise was checked last; empty if neither is known."""
    number = re.match(r"0*(\d+)_", os.path.basename(os.environ.get(NOTEBOOK, "")))
    of_notebook = (key for key, title in CHAPTERS.items() if number and title.startswith(f"{number[1]} "))
    return next(of_notebook, _last_asked.rpartition("-")[0])


def load_ipython_extension(shell: Any) -> None:
    """Register `%progress`. The kernels of the course's environment do so by themselves."""
    from IPython.core.magic import MAGIC_NO_VAR_EXPAND_ATTR

    def show_progress(line: str) -> progress.Progress | None:
        """Show what you have solved: in all, in this notebook's chapter, in the others."""
        if line.strip():
            print('%progress takes no argument: it shows all chapters. For one exercise: check("topics-1")')
            return None
        return progress.Progress(_chapter_at_hand())

    # IPython would look for variables in the line, which takes minutes in a long one.
    setattr(show_progress, MAGIC_NO_VAR_EXPAND_ATTR, True)
    shell.magics_manager.register_function(show_progress, magic_kind="line", magic_name="progress")
