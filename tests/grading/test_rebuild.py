"""The notebook that is graded: its cells, what of a hand-in is taken, and that plain nbval sees the same."""

from __future__ import annotations

import functools
import json
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest

from course_kit.classroom.rebuild import LONGEST_ANSWER, answers_of, rebuilt
from course_kit.exercises.notebooks import reference
from course_kit.exercises.notebooks.definitions import definitions
from course_kit.exercises.notebooks.reference import CHECK, Chapter, is_untouched, mark_of, prerequisites
from tests.exercises.chapter import answers_to
from tests.grading.handed_in import CHAPTERS, as_bytes, notebook, references

NAME = "04_services.ipynb"


@functools.cache  # some are made while tests are collected, in each process
def _answered() -> bytes:
    return as_bytes(notebook("services", {"services-1": "right = True"}))


def handed_in(cells: list[dict] | None = None, **changes: object) -> bytes:
    """Chapter 4 with an answer to services-1; `changes` to its answer cell."""
    made = json.loads(_answered())
    for cell in made["cells"]:
        if cell["id"] == "services-ex1-answer":
            cell.update(changes)
    made["cells"] += cells or []
    return json.dumps(made).encode()


def taken(data: bytes) -> tuple[dict[str, str], str]:
    answers = answers_of(data, NAME, CHAPTERS["services"])
    return dict(answers.sources), " ".join(answers.notes)


def test_only_what_a_student_has_changed_is_an_answer():
    assert taken(handed_in()) == ({"services-1": "right = True"}, "")


@pytest.mark.parametrize("source", ["a\nb", ["a\n", "b"]])
def test_a_source_is_a_text_or_its_lines(source: object):
    assert taken(handed_in(source=source))[0] == {"services-1": "a\nb"}


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"", "cannot be read as a notebook"),
        (b"\xff\xfe", "cannot be read as a notebook"),
        (b"[1]", "cannot be read as a notebook"),
        (b'{"cells": 3}', "cannot be read as a notebook"),
        (b"[" * 100_000, "cannot be read as a notebook"),
        (
            b'{"cells": [3, {"id": 4}, {"id": "services-ex1-answer"}]}',
            "services-ex1-answer of 04_services.ipynb is no cell",
        ),
        (handed_in(cell_type="markdown"), "is no cell of code"),
        (handed_in(source=3), "is no cell of code"),
        (handed_in(source=["a", 3]), "is no cell of code"),
        (handed_in(id="services-ex9-answer"), "services-ex1-answer of 04_services.ipynb is missing"),
        (handed_in([{"id": "services-ex1-answer", "cell_type": "code", "source": "b"}]), "is there 2 times"),
        (handed_in(source="#" * (LONGEST_ANSWER + 1)), "is longer than"),
    ],
    ids=["empty", "binary", "list", "number", "deep", "odd", "markdown", "int", "ints", "missing", "twice", "long"],
)
def test_what_is_no_answer_is_said_and_costs_its_own_points_only(data: bytes, says: str):
    sources, notes = taken(data)
    assert "services-1" not in sources
    assert says in notes


def test_swapped_ids_swap_the_answers():
    made = notebook("services", {"services-1": "a = 1", "services-2": "b = 2"})
    first, second = (next(c for c in made.cells if c.id == f"services-ex{number}-answer") for number in (1, 2))
    first.id, second.id = second.id, first.id
    assert taken(as_bytes(made))[0] == {"services-1": "b = 2", "services-2": "a = 1"}


def test_cells_of_ones_own_are_left_out_and_that_is_said():
    own = {"id": "mine", "cell_type": "code", "source": "help = 1", "metadata": {}, "outputs": []}
    empty = {**own, "id": "empty", "source": " \n"}
    assert "1 cell of your own was left out" in taken(handed_in([own, empty]))[1]


def test_half_a_character_does_no_harm():
    assert taken(handed_in(source="x = '\ud800'"))[0] == {"services-1": "x = '?'"}


def test_cells_are_the_courses_but_for_the_sources_of_answers():
    made = rebuilt(CHAPTERS["topics"], {"topics-2": "mine = 1"}, ["topics-2", "topics-3"])
    nbformat.validate(made)
    own = {cell.id: cell.source for cell in CHAPTERS["topics"].notebook.cells}
    changed = [cell.id for cell in made.cells if own.get(cell.id) not in (cell.source, None)]
    ids = {cell.id for cell in prerequisites(CHAPTERS["topics"])}
    assert set(changed) <= {"topics-ex2-answer", *ids}
    assert [cell.id for cell in made.cells if mark_of(cell).get("role") == CHECK] == [
        "topics-ex2-check",
        "topics-ex3-check",
    ]
    tags = [cell.metadata.get("tags", []) for cell in made.cells if cell.cell_type == "code"]
    assert {tag for each in tags for tag in each} == {"nbval-ignore-output"}


def test_definitions_are_what_an_answer_may_build_on():
    source = """
import math
from a import b, \\
    c
value, text = 3, "a"
node = run(Node)

@dataclass
class A:
    x = node
    # a remark

A.run = node.run
A.x = 3
async def f():
    await g()

for number in range(3):
    print(number)
"""
    kept = definitions(source)
    assert "from a import b, \\\n    c" in kept
    assert "@dataclass\nclass A:\n    x = node" in kept
    assert "A.run = node.run" in kept
    assert "async def f" in kept
    assert all(text not in kept for text in ("run(Node)", "A.x", "for number"))
    assert definitions(kept) == kept
    assert definitions("%%writefile x\nimport a") == definitions("%ros2 node list") == ""


@pytest.mark.timeout(200)
def test_plain_nbval_sees_the_same_verdicts(tmp_path: Path):
    """An instructor who runs `pytest --nbval` on a rebuilt notebook, without the grader."""
    wrong = next(a for a in answers_to("services") if a.exercise == "services-4").wrong[0]
    sources = {**references("services"), "services-4": wrong.source}
    asked = ["services-1", "services-3", "services-4"]
    path = tmp_path / NAME
    nbformat.write(rebuilt(CHAPTERS["services"], sources, asked), path)
    command = [sys.executable, "-m", "pytest", "--nbval", "-p", "no:cacheprovider", "-v", path.name]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=180)
    cells = [cell for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == "code"]
    checks = {mark_of(c)["exercise"]: number for number, c in enumerate(cells) if mark_of(c).get("role") == CHECK}
    passed = {name: f"::Cell {number} PASSED" in done.stdout for name, number in checks.items()}
    assert passed == {"services-1": True, "services-3": True, "services-4": False}, done.stdout[-3000:]
    assert f"1 failed, {len(cells) - 1} passed" in done.stdout


@pytest.mark.parametrize("source", ["", "\n# class Echo(Node):\n#     ...\n", "a = None  # a number\nb = None\n"])
def test_a_cell_without_an_answer_is_untouched(source: str):
    assert is_untouched(source)


@pytest.mark.parametrize("source", ["a = 1", "a = None; b = 2", "%%bash\nls", "a = '''\n# b\n'''", "None", "a\n= None"])
def test_a_cell_with_an_answer_is_not(source: str):
    assert not is_untouched(source)


def test_no_answer_is_taken_from_the_reference_itself():
    """Whoever grades may have typed some into the notebooks of the course."""
    answers = {"setup-1": "domain = 7", "setup-2": "class Greeter(Node): ...", "setup-4": "new_topics = {'/a'}"}
    chapter = Chapter("01_setup_checks.ipynb", as_bytes(notebook("setup", answers)).decode())
    assert [chapter.untouched(name) for name in answers] == [
        "domain = None\ndiscovery_range = None",
        "",
        "new_topics = None",
    ]
    made = rebuilt(chapter, {}, list(answers))
    assert not any(answer in cell.source for cell in made.cells for answer in answers.values())


def test_a_clone_has_its_chapters_from_git_whatever_is_typed_into_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(reference, "ROOT", tmp_path)
    notebooks = tmp_path / "notebooks"
    notebooks.mkdir()
    committed = as_bytes(notebook("services", {}))
    (notebooks / NAME).write_bytes(committed)
    assert [one.file for one in reference.chapters.__wrapped__()] == [NAME]  # no clone: as it is
    git = ("git", "-C", str(tmp_path), "-c", "user.name=a", "-c", "user.email=a@b")
    for words in (("init", "-q"), ("add", "."), ("commit", "-qm", "The course")):
        subprocess.run([*git, *words], check=True)
    (notebooks / NAME).write_bytes(as_bytes(notebook("services", {"services-1": "mine = 1"})))
    (clone,) = reference.chapters.__wrapped__()
    assert clone.text.encode() == committed
    monkeypatch.setenv("PATH", str(tmp_path))  # without git
    (without,) = reference.chapters.__wrapped__()
    assert "mine = 1" in without.text


def test_an_edition_has_copies_of_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (full,) = (chapter for chapter in reference.chapters() if chapter.file == NAME)
    (tmp_path / NAME).write_text(reference.stripped(full.notebook))
    monkeypatch.setattr(reference, "EDITION", tmp_path)
    (copied,) = reference.chapters.__wrapped__()
    assert (copied.order, copied.tasks) == (full.order, full.tasks)
    assert [c.source for c in prerequisites(copied)] == [c.source for c in prerequisites(full)]
