"""The environment of the course: checks of the machine, pinned packages, and set-up.

This package is part of every start of Python in the course's environment, so importing it loads nothing.
"""

from __future__ import annotations

TYPE_CHECKING = False  # type checkers take it for True; importing typing would cost every start 5 ms
if TYPE_CHECKING:
    from course_kit.setup.environment.report import Report


def check_environment() -> Report:
    """Every check of this machine and of the environment that this Python runs in; takes about 2 s.

    A notebook shows the report as a table; its `.failed` lists what has to be cured.
    """
    from course_kit.setup.environment import checklist, report

    return report.Report(checklist.of_this_python())
