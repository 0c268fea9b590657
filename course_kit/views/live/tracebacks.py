"""Shows an error in a cell: the student's frames alone, and below them the cause and the cure."""

from __future__ import annotations

import functools
from typing import Any

from course_kit.ros.causes import cause_of
from course_kit.ros.causes.frames import folded

BOLD, PLAIN = "\x1b[1m", "\x1b[0m"


def fold(shell: Any) -> None:
    """Have the shell show tracebacks so; `%xmode Verbose` shows all of them."""
    plain = shell.InteractiveTB.structured_traceback
    if hasattr(plain, "is_of_the_course"):
        return

    @functools.wraps(plain)
    def structured_traceback(etype: Any, evalue: Any = None, etb: Any = None, *args: Any, **kwargs: Any) -> list[str]:
        if not isinstance(evalue, BaseException) or shell.InteractiveTB.mode == "Verbose":
            return list(plain(etype, evalue, etb, *args, **kwargs))
        whole = evalue.__traceback__
        evalue.__traceback__ = etb
        try:
            cause = cause_of(evalue)
            with folded(evalue):
                shown = list(plain(etype, evalue, evalue.__traceback__, *args, **kwargs))
        finally:
            evalue.__traceback__ = whole
        return [*shown, f"{BOLD}→ {cause}{PLAIN}"] if cause else shown

    structured_traceback.is_of_the_course = True  # type: ignore[attr-defined]
    shell.InteractiveTB.structured_traceback = structured_traceback
