"""How often a notebook is run until each of its exercises has its verdict."""

from __future__ import annotations

from typing import Any

import pytest

from course_kit.classroom.run import notebook_run, sandbox
from course_kit.classroom.run.notebook_run import Settings
from course_kit.exercises.notebooks import reference
from tests.grading.handed_in import references

pytestmark = [
    pytest.mark.cpu_bound,
    pytest.mark.by_turns("gradings in kernels"),
    pytest.mark.timeout(180),
    pytest.mark.skipif(not sandbox.is_available(), reason="there is no bubblewrap that can make sandboxes"),
]
SETUP = next(chapter for chapter in reference.chapters() if chapter.name == "setup")
RIGHT = {name: references("setup")[name] for name in ("setup-1", "setup-2")}
WRONG = 'domain, discovery_range = 99, "SUBNET"\n'
ENDS = "import os; os._exit(0)"


@pytest.mark.parametrize(
    ("answers", "points", "runs"),
    [
        (RIGHT, {"setup-1": 1, "setup-2": 2}, [["setup-1", "setup-2"]]),
        (RIGHT | {"setup-1": WRONG}, {"setup-1": 0, "setup-2": 2}, [["setup-1", "setup-2"]]),
        (
            RIGHT | {"setup-1": WRONG + ENDS},
            {"setup-1": 0, "setup-2": 2},
            [["setup-1", "setup-2"], ["setup-1"], ["setup-2"]],
        ),
    ],
    ids=["right", "wrong", "ends"],
)
def test_a_notebook_is_run_once_unless_its_kernel_ends(
    answers: dict[str, str], points: dict[str, int], runs: list[list[str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[list[str]] = []

    class Noted(notebook_run._Run):
        def __init__(self, *arguments: Any) -> None:
            seen.append(sorted(arguments[1]))
            super().__init__(*arguments)

    monkeypatch.setattr(notebook_run, "_Run", Noted)
    found = notebook_run.grade(SETUP, answers, list(answers), Settings(timeout=30.0))
    assert {name: one.result.verdict.points for name, one in found.items()} == points
    assert seen == runs
