"""The check of workspace-1: a package with a program."""

from __future__ import annotations

import re

from course_kit.exercises.checker.assertions import expect
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.workspace_assertions import expect_executable, expect_package, run_to_end, said

WARNING = re.compile(r"^\s|warning", re.IGNORECASE)  # of Python, of what the student did not write


@check_of("workspace-1")
def greeter() -> None:
    """The package is built, and its program greets."""
    expect_package("greeter", "ament_python", points=1)
    expect_executable("greeter", "greet")
    greet = run_to_end("ros2", "run", "greeter", "greet", timeout=15.0)
    lines = [line.strip() for line in greet.lines if line.strip() and not WARNING.search(line)]
    expect(
        "`ros2 run greeter greet` says `Hi from greeter.`, nothing else, and ends with status 0",
        greet.status == 0 and lines == ["Hi from greeter."],
        f"{said(greet)}`--node-name greet` makes a program that says so, in one line: leave it as it was made.",
    )
