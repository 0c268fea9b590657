"""Worked solutions: every exercise has one, and solution() shows it after full points or three tries, not before."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from course_kit import solution
from course_kit.exercises import catalogue
from course_kit.exercises.in_notebook import check, checker_client, checker_environment, progress
from course_kit.exercises.protocol.verdict import NOT_BEGUN, Finding, Verdict
from course_kit.exercises.solutions import answered, worked
from tests.exercises.chapter import Chapter, answers_to, changed, chapter, solved
from tests.exercises.chapter import worked as reference

NAMES = [each.name for each in catalogue.EXERCISES]
NOT_FULL = Verdict("topics-2", "", 2, findings=(Finding("counts", True, "", 1), Finding("all", False, "Why?", 1)))
FULL = Verdict("topics-2", "", 2, findings=(Finding("all", True, max_points=2),))


# ---- The files


def test_every_exercise_has_a_solution_and_every_solution_an_exercise() -> None:
    assert sorted(path.stem for folder in worked.folders() for path in folder.iterdir()) == sorted(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_a_solution_is_its_reason_in_a_few_sentences_and_cells(name: str) -> None:
    text = solved(name).text
    reason, *_ = text.split("```")
    assert 1 <= len(re.findall(r"[.?!)](?:\s|$)", reason)) <= 6
    assert 15 <= len(reason.split()) <= 75
    assert re.sub(r"^```\w+\n.*?^```\n", "", text, flags=re.MULTILINE | re.DOTALL).strip() == reason.strip()
    assert solved(name).cells


def test_one_that_is_not_there_is_none() -> None:
    assert worked.find("topics-99") is None and not worked.is_there("topics-99")


def test_files_are_those_that_cells_write() -> None:
    files = solved("workspace-5").files
    assert list(files) == [
        f"ros2_ws/src/patrol/{name}"
        for name in ("patrol/patrol.py", "launch/patrol.launch.py", "config/one.yaml", "config/two.yaml")
    ]
    assert files["ros2_ws/src/patrol/config/one.yaml"] == "/**:\n  ros__parameters:\n    side: 1.0\n    speed: 1.5\n"
    assert "%%" not in solved("workspace-5").code and "class Patrol" not in solved("workspace-5").code


def test_several_cells_are_numbered_and_one_is_not() -> None:
    numbered = solved("workspace-3").numbered
    assert re.findall(r"^\*Cell (\d) of (\d)\*$", numbered, re.MULTILINE) == [("1", "3"), ("2", "3"), ("3", "3")]
    assert worked.Worked(numbered).cells == solved("workspace-3").cells
    assert solved("topics-2").numbered == solved("topics-2").text


# ---- The answer


def test_the_newest_cell_that_defines_a_class_is_the_answer() -> None:
    cells = ["class A: x = 1", "if True:\n    class A:\n        x = 2", "A()", "class B(A): pass", "class A", None]
    assert answered.class_source("A", cells) == "class A:\n        x = 2"
    assert answered.class_source("C", cells) is None


def test_the_newest_cell_that_defines_a_function_is_the_answer_and_no_method_is() -> None:
    cells = ["def f(x): return x", "import f\ndef f(x):\n    return 2", "class A:\n    def f(self): pass", "f(3)", None]
    assert answered.function_source("f", cells) == "def f(x):\n    return 2"
    assert answered.function_source("A", cells) is None
    assert answered.class_source("f", cells) is None


def test_plain_values_are_read_from_tuples_too() -> None:
    source = 'a, b = "x", {2, 1}\nc = int(a)\nd = e = 3\n(f, g) = h'
    assert list(answered.plain_values(source)) == [("a", "x"), ("b", {1, 2}), ("d", 3)]


# ---- Tries


@pytest.fixture
def state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    return tmp_path


def left() -> int:
    return progress.tries_left("topics-2", 2)


def test_what_is_begun_and_not_full_counts(state: Path) -> None:
    progress.record(Verdict("topics-2", "", 2, NOT_BEGUN))
    assert left() == 3
    for expected in (2, 1, 0, 0):
        progress.record(NOT_FULL)
        assert left() == expected
    assert progress.load() == {"topics-2": 1}
    assert progress.tries_left("topics-1", 2) == 3


def test_full_points_open_it_at_once_and_for_good(state: Path) -> None:
    progress.record(FULL)
    assert left() == 0
    progress.record(NOT_FULL)
    assert left() == 0 and progress.load() == {"topics-2": 2}


def test_a_file_of_an_older_course_is_read_and_goes_on(state: Path) -> None:
    progress.path().parent.mkdir(parents=True)
    progress.path().write_text('{"points": {"topics-2": 1, "topics-1": 2}}')
    assert left() == 3 and progress.load() == {"topics-2": 1, "topics-1": 2}
    progress.record(NOT_FULL)
    assert left() == 2
    assert json.loads(progress.path().read_text()) == {
        "points": {"topics-1": 2, "topics-2": 1},
        "tries": {"topics-2": 1},
    }


@pytest.mark.parametrize("tries", ["3", '{"a": "x"}', '{"a": Infinity}', "null"])
def test_tries_that_cannot_be_read_are_said_to_be(state: Path, tries: str, capsys: pytest.CaptureFixture[str]) -> None:
    progress.path().parent.mkdir(parents=True)
    progress.path().write_text(f'{{"points": {{}}, "tries": {tries}}}')
    solution("topics-2")
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith("solution: your earlier points cannot be read from ")
    assert "after 3 more tries" in said[1] and len(said) == 2


# ---- What is said


def said(capsys: pytest.CaptureFixture[str]) -> str:
    text = capsys.readouterr().out
    assert text.count("\n") == 1, text
    return text


def test_before_it_is_open_a_line_says_what_is_left(state: Path, capsys: pytest.CaptureFixture[str]) -> None:
    solution("topics-2")
    assert said(capsys).startswith("solution: topics-2 opens with full points or after 3 more tries")
    progress.record(NOT_FULL)
    progress.record(NOT_FULL)
    solution("topics-2")
    assert "after 1 more try. Until then, the hints of its check say where to look." in said(capsys)


def test_then_the_reason_and_the_code_are_shown(state: Path, capsys: pytest.CaptureFixture[str]) -> None:
    progress.record(FULL)
    solution("topics-2")
    shown = capsys.readouterr().out
    assert shown.startswith("**topics-2 · Why does nothing arrive?**: a solution\n\nThe laser offers best effort.")
    assert "```python\nfrom rclpy.qos import qos_profile_sensor_data\n" in shown


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (("def cells", "# Mine.\ndef cells"), "- Your `cells_of_beam` is the same code."),
        (("math.floor(up", "int(up"), "-        return (int(up / resolution), math.floor(across / resolution))\n+    "),
        (("def cells_of_beam", "def other"), "- No cell that ran here has `def cells_of_beam`: run your answer,"),
    ],
)
def test_of_a_function_too_it_is_said_what_differs(
    state: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], change: tuple[str, str], told: str
) -> None:
    code = changed(reference("robot-3"), change)
    monkeypatch.setattr(answered, "cells_run", lambda: [code, "class Old:\n    def cells_of_beam(self): pass"])
    monkeypatch.setattr(check, "names", lambda: {"cells_of_beam": print})
    progress.record(Verdict("robot-3", "", 3, findings=(Finding("all", True, max_points=3),)))
    solution("robot-3")
    assert told in capsys.readouterr().out.partition("**And yours?**")[2]


def test_while_it_is_graded_none_is_shown(
    state: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    progress.record(FULL)
    monkeypatch.setattr(
        checker_environment, "at_start", lambda: {checker_client.GRADER: "/run/grading/meeting/checker"}
    )
    solution("topics-2")
    assert said(capsys) == "solution: none is shown while an answer is graded.\n"


def test_an_edition_without_says_so(
    state: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    progress.record(FULL)
    monkeypatch.setattr(worked, "EXERCISES", tmp_path)
    solution("topics-2")
    assert said(capsys).startswith("solution: this edition of the course has no solutions.")


@pytest.mark.parametrize(
    ("verdict", "tries", "expected"), [(NOT_FULL, 1, ""), (NOT_FULL, 3, "a worked"), (FULL, 1, "how")]
)
def test_the_last_line_of_a_verdict_says_when_it_is_open(
    state: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    verdict: Verdict,
    tries: int,
    expected: str,
) -> None:
    monkeypatch.setattr(checker_client, "ask", lambda *_: verdict)
    for _ in range(tries):
        capsys.readouterr()
        check.check("topics-2")
    last = capsys.readouterr().out.splitlines()[-1].strip()
    assert last.startswith(f'`solution("topics-2")` shows {expected}') if expected else "solution" not in last


def test_a_repetition_with_a_seed_is_no_try(state: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(checker_client, "ask", lambda *_: NOT_FULL)
    for _ in range(4):
        check.check("topics-2", seed=3)
    assert left() == 3


def test_the_line_is_in_the_html_too() -> None:
    html = Verdict("a-1", "A", 1, further='`solution("a-1")` shows <it>.')._repr_html_()
    assert "<code>solution(&quot;a-1&quot;)</code> shows &lt;it&gt;." in html


# ---- In a kernel


@pytest.fixture(scope="module")
def topics() -> Iterator[Chapter]:
    with chapter("topics") as opened:
        opened.kernel.run("from course_kit import solution")
        yield opened


def shown(opened: Chapter, name: str) -> dict[str, Any]:
    """What solution() displays of an exercise."""
    cell = opened.kernel.run(f"solution({name!r})")
    displayed = [m["content"]["data"] for m in opened.kernel.of(cell) if m["msg_type"] == "display_data"]
    assert len(displayed) == 1, opened.kernel.text(cell)
    return dict(displayed[0])


@pytest.mark.timeout(300)
@pytest.mark.xdist_group("solutions of topics")
def test_after_three_wrong_answers_it_is_shown_with_what_differs_and_its_code_is_right(topics: Chapter) -> None:
    wrong = changed(reference("topics-2"), (", qos_profile_sensor_data)", ", 10)"), ('"scan"', '"/scan"'))
    for number in (3, 2, 1):
        text = topics.kernel.text(topics.kernel.run('solution("topics-2")'))
        assert f"after {number} more tr" in text and text.count("\n") == 1
        verdict = topics.answer("topics-2", wrong)
        assert ("solution(" in verdict) == (number == 1), verdict
    told = shown(topics, "topics-2")
    assert told["text/plain"] == told["text/markdown"]
    compared = told["text/markdown"].partition("**And yours?**")[2].strip()
    assert compared == "- Your subscription for `scan` is RELIABLE, the solution's BEST_EFFORT."
    (cell,) = worked.Worked(told["text/markdown"]).cells
    verdict = topics.answer("topics-2", cell)
    assert ": 2 of 2 points" in verdict and '`solution("topics-2")` shows how' in verdict.splitlines()[-1]
    assert "Your `ScanCounter` is the same code." in shown(topics, "topics-2")["text/markdown"]


@pytest.mark.timeout(300)
@pytest.mark.xdist_group("solutions of topics")
@pytest.mark.parametrize("name", ["topics-1", "topics-3"])
def test_what_is_shown_is_a_right_answer(topics: Chapter, name: str) -> None:
    answers = next(each for each in answers_to("topics") if each.exercise == name)
    assert "✘" not in topics.answer(name, next(iter(answers.right.values())))
    (cell,) = worked.Worked(shown(topics, name)["text/markdown"]).cells
    assert f": {answers.points} of {answers.points} points" in topics.answer(name, cell)


@pytest.mark.xdist_group("solutions of topics")
def test_whatever_stands_in_the_notebook_it_is_shown(topics: Chapter) -> None:
    assert ": 2 of 2 points" in topics.answer("topics-2", reference("topics-2"))
    for code in ("del ScanCounter", "ScanCounter = 3", "In.clear(); In.extend([None, 3, 'class ScanCounter'])"):
        topics.kernel.finish(topics.kernel.send(code))
        assert "class ScanCounter(Node):" in shown(topics, "topics-2")["text/markdown"]
