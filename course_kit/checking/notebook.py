"""check() in a notebook: asks the checker, shows what it found, keeps the points."""

from __future__ import annotations

import os
import sys
from typing import Any

from course_kit import kernel
from course_kit.checking import client, progress
from course_kit.examining.channel import as_json
from course_kit.examining.verdict import GRADED, NOT_BEGUN, Verdict

STRICT = "COURSE_KIT_STRICT"
_points_only = False


def check(exercise: str, value: Any = None, seed: int | None = None) -> None:
    """Check your answer to an exercise, such as `check("topics-1")`, and show what was found.

    `value` is your answer where the exercise asks for a value. Nothing of yours is changed: nodes that run go on.
    A check draws the numbers, orders and moments that it tries; `seed`, as a verdict has it, has it draw the same
    again. The points of such a repetition are not kept.
    With COURSE_KIT_STRICT=1 in the environment, an answer that is begun and not all right raises AssertionError.
    """
    try:
        verdict = client.ask(exercise, as_json(value), _names(), seed)
    except Exception as error:  # a check never breaks a student's notebook
        is_refused = isinstance(error, client.Refused | TypeError)
        print(f"check: {error}" if is_refused else f"check: {exercise} could not be checked: {error}")
        _be_strict(str(error))
        return
    if _points_only or verdict.state == GRADED:
        print(verdict.heading)
        return
    _show(verdict)
    try:
        if seed is None and (notice := progress.record(verdict)):
            print(f"check: {notice}")
    except OSError as error:
        print(f"check: your points could not be kept: {error}")
    if verdict.state != NOT_BEGUN and not verdict.is_full:
        _be_strict(str(verdict))


def show_points_only() -> None:
    """Have checks show nothing that varies from one to the next, as in a notebook that a grader has rebuilt."""
    global _points_only
    _points_only = True


def _be_strict(reason: str) -> None:
    if os.environ.get(STRICT) == "1":
        raise AssertionError(reason)


def _names() -> dict[str, Any]:
    """The variables of the notebook, or of the program that was started."""
    running = kernel.shell()
    return running.user_ns if running is not None else vars(sys.modules["__main__"])


def _show(verdict: Verdict) -> None:
    if kernel.shell() is not None:
        from IPython.display import display

        display(verdict)
    else:
        print(verdict)


def load_ipython_extension(shell: Any) -> None:
    """Register `%progress`. The kernels of the course's environment do so by themselves."""

    def show_progress(line: str) -> progress.Progress:
        """Show what you have solved, by chapter."""
        return progress.Progress()

    shell.magics_manager.register_function(show_progress, magic_kind="line", magic_name="progress")
