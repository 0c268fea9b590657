"""The output of environment-check.sh once it has found a Python.

python -m course_kit.setup.environment [--json] STATE     STATE is that of .venv, as stamp.py says it
python -m course_kit.setup.environment --before-set-up    only what makes set-up vain, if there is anything
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from course_kit.setup.environment import checklist, report, stamp


def main(arguments: Sequence[str]) -> int:
    """Print the report; the exit status is 1 if a check failed."""
    state = arguments[-1]
    if state == "--before-set-up":
        obstacles = report.failed(checklist.before_set_up(os.environ))
        if obstacles:
            print(report.text(obstacles[:1]))
        return 1 if obstacles else 0
    checks = checklist.of_project(os.environ, state)
    if "--json" in arguments:
        print(report.as_json(checks))
    else:
        print(report.text(checks, colour=sys.stdout.isatty() and not os.environ.get("NO_COLOR")))
        if not report.failed(checks):
            start = "start the course" if state in stamp.USABLE else "set it up and start the course"
            print(f"\nNext: ./environment-check.sh lab, to {start}.")
    return 1 if report.failed(checks) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
