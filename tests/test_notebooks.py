"""Every notebook: its form, and that it runs top to bottom without network; in a slow run twice in one kernel."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import nbformat
import pytest
from jupyter_client.kernelspec import get_kernel_spec

from course_kit.classroom.release import KEPT_EMPTY
from course_kit.exercises.notebooks import reference
from course_kit.exercises.notebooks.definitions import definitions
from course_kit.setup.environment.checks.notebook import START
from tests.lab import CHROMIUM

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("[0-9][0-9]_*.ipynb"))
PAGES = [FOLDER / START, *NOTEBOOKS]  # the chapters, and what is run as they are
LOOPBACK_ONLY = ["unshare", "--net", "--", "sh", "-c", 'ip link set lo up && exec "$@"', "sh"]
CELL_TIMEOUT = 400  # seconds: a cell that hangs is named
NBVAL = [
    sys.executable,
    "-m",
    "pytest",
    "--nbval",
    f"--nbval-cell-timeout={CELL_TIMEOUT}",
    "-p",
    "no:cacheprovider",
    "-q",
]
LINES = 15

of_each_page = pytest.mark.parametrize("path", PAGES, ids=[path.stem for path in PAGES])
of_each = pytest.mark.parametrize("path", NOTEBOOKS, ids=[path.stem for path in NOTEBOOKS])


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A copy of the notebooks, as a student has it who has run none of them."""
    return Path(shutil.copytree(FOLDER, tmp_path / "notebooks", ignore=shutil.ignore_patterns("*_ws*", ".*")))


def cells(path: Path) -> list:
    return nbformat.read(path, as_version=4).cells


def again(cell: nbformat.NotebookNode) -> nbformat.NotebookNode:
    """A cell's copy for a second run, in which a count or a first build may come out otherwise."""
    copy = nbformat.from_dict({**cell, "id": f"{cell.id}-once-more"})
    copy.metadata.tags = sorted({*copy.metadata.get("tags", []), "nbval-ignore-output"})
    return copy


def beside_each_other() -> Iterator[Any]:
    for path in PAGES:
        yield pytest.param(path, id=path.stem, marks=pytest.mark.xdist_group(path.stem))


@pytest.mark.by_turns("a chapter each")
@pytest.mark.cpu_bound
@pytest.mark.parametrize("path", list(beside_each_other()))
@pytest.mark.timeout(720)
def test_runs_top_to_bottom_without_network(path, folder, request):
    """With nbval, as a student runs it who has run no other; in a slow run again in the same kernel, by a browser."""
    notebook = nbformat.read(path, as_version=4)
    count = sum(cell.cell_type == "code" for cell in notebook.cells)
    command, place = [*NBVAL, "-p", "tests.foreign_words", path.name], folder
    is_twice = request.config.getoption("tier") in ("full", "all")
    if is_twice and CHROMIUM:
        command, place = [sys.executable, "-m", "tests.second_run", str(folder / path.name)], ROOT
        count += 1
    elif is_twice:
        notebook.cells += [again(cell) for cell in notebook.cells]
        nbformat.write(notebook, folder / path.name)
        count *= 2
    if os.geteuid() == 0 and shutil.which("ip"):
        command = [*LOOPBACK_ONLY, *command]
    else:
        warnings.warn("run with the network: to be without it takes root and the command ip", stacklevel=1)
    environment = os.environ | {
        "PYTHONPATH": str(ROOT)
    }  # for the plugin alone: the kernel has it, but imports the same
    done = subprocess.run(command, cwd=place, env=environment, capture_output=True, text=True, timeout=700)
    assert done.returncode == 0, done.stdout[-6000:] + done.stderr[-2000:]
    assert f"{count} passed" in done.stdout, done.stdout[-2000:]


def is_kept_empty(cell: nbformat.NotebookNode) -> bool:
    return KEPT_EMPTY in cell.metadata.get("tags", [])


@of_each
def test_each_saved_console_is_known_to_be_one(path):
    """So that JupyterLab shows none as that of a node that runs, as course_kit/views/live/shown.py has it."""
    for cell in nbformat.read(path, 4).cells:
        for output in cell.get("outputs", []):
            if "course-kit-console" in output.get("data", {}).get("text/html", ""):
                assert output["data"]["application/vnd.course-kit.view+json"] == {"view": "console"}, cell.id
                assert "class='course-kit-state'" in output["data"]["text/html"], cell.id


@of_each_page
def test_is_valid_and_was_run(path):
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    assert (notebook.nbformat, notebook.nbformat_minor) == (4, 5)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    counts = [None if is_kept_empty(cell) else number for number, cell in enumerate(code, 1)]
    hint = f"run all cells in a fresh kernel, clear the outputs of those tagged {KEPT_EMPTY}, then save"
    assert [cell.execution_count for cell in code] == counts, hint
    assert not any(cell.outputs for cell in code if is_kept_empty(cell)), hint


def test_nothing_is_stored_about_the_machine_of_whoever_ran_chapter_1():
    empty = [cell.id for cell in cells(NOTEBOOKS[0]) if is_kept_empty(cell)]
    assert empty == ["setup-distro", "setup-machine", "setup-report", "setup-which-ros"]


@of_each_page
def test_each_stored_picture_has_its_alternative_text(path):
    for cell in cells(path):
        for output in cell.get("outputs", []):
            if "image/png" in output.get("data", {}):
                text = output.metadata.get("image/png", {}).get("alt", "")
                assert text == output.data["text/plain"] and len(text) > 30, cell.id


@of_each_page
def test_the_kernel_has_the_name_that_the_launcher_shows(path):
    """JupyterLab would write another one into the notebook, and call it changed, as soon as it is opened."""
    spec = nbformat.read(path, as_version=4).metadata.kernelspec
    installed = get_kernel_spec("python3")
    assert (spec.name, spec.display_name) == ("python3", installed.display_name) == ("python3", "ROS 2 Jazzy (course)")


@of_each
def test_cells_are_named_short_and_without_errors(path):
    names = [cell.id for cell in cells(path)]
    assert len(set(names)) == len(names)
    chapter = names[0].split("-")[0]
    for cell in cells(path):
        assert re.fullmatch(rf"{chapter}(-[a-z0-9]+)+", cell.id), cell.id
        if cell.cell_type == "code":
            lines = [line for line in cell.source.splitlines() if line.strip()]
            assert len(lines) <= LINES, f"{cell.id} has {len(lines)} lines"
            assert not any(output.output_type == "error" for output in cell.outputs), cell.id


@of_each
def test_begins_and_ends_as_every_chapter_does(path):
    text = "\n".join(cell.source for cell in cells(path) if cell.cell_type == "markdown")
    first = cells(path)[0].source
    assert re.match(r"# \d · .+\n> .+\n", first)
    assert all(f"**{word}**" in first for word in ("Goal", "Time", "You need"))
    headings = re.findall(r"^## (.+)$", text, re.MULTILINE)
    assert headings[-3:] == ["Summary", "Exercises", "Next"]


@of_each
def test_every_exercise_has_a_cell_for_its_answer_and_one_that_checks_it(path):
    roles = {"exercise": [], "answer": [], "check": []}
    for cell in cells(path):
        mark = cell.metadata.get("course_kit", {})
        if "exercise" in mark:
            roles[mark["role"]].append((mark["exercise"], mark["points"]))
    assert roles["exercise"] == roles["answer"] == roles["check"]
    assert len(roles["exercise"]) >= 4


@of_each
def test_every_cell_that_defines_something_is_marked_for_grading(path):
    """An answer may build on it; but for what imports packages that a student has built meanwhile."""
    unmarked = [
        c.id for c in cells(path) if c.cell_type == "code" and not reference.mark_of(c) and definitions(c.source)
    ]
    assert set(unmarked) <= {"workspace-interfaces-imported", "services-own-server"}


@of_each_page
def test_committed_outputs_name_no_path_of_a_machine(path):
    for cell in cells(path):
        if cell.cell_type == "code" and "nbval-ignore-output" not in cell.metadata.get("tags", []):
            assert not re.search(r"/(root|home|tmp|work)/", str(cell.outputs)), cell.id
