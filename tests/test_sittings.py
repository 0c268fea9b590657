"""A chapter can be taken in sittings: after a restart from each place to stop, and without what can be left out."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import nbformat
import pytest

from tests.test_notebooks import FOLDER, NBVAL, NOTEBOOKS

# What another test of this process has left would be counted by a chapter's `topic info`.
pytestmark = [pytest.mark.usefixtures("fresh_domain"), pytest.mark.cpu_bound]

CAN_BE_LEFT_OUT = re.compile(r"## .+\n\*.*can be left out\*")


def resume_cells() -> Iterator[Any]:
    """Each place to stop: the notebook, and the cell to go on with."""
    for path in NOTEBOOKS:
        for cell in nbformat.read(path, as_version=4).cells:
            if "resume" in cell.metadata.get("tags", []):
                yield pytest.param(path, cell.id, id=cell.id, marks=pytest.mark.xdist_group(cell.id))


def with_optional_sections() -> Iterator[Any]:
    """The chapters that have sections which can be left out."""
    for path in NOTEBOOKS:
        if any(CAN_BE_LEFT_OUT.match(cell.source) for cell in nbformat.read(path, as_version=4).cells):
            yield pytest.param(path, id=path.stem, marks=pytest.mark.xdist_group(f"{path.stem}-shorter"))


def run(path: Path, cells: list[nbformat.NotebookNode], folder: Path) -> None:
    """These cells of a chapter under nbval, in the kernel and folder of somebody who has run no other."""
    shutil.copytree(FOLDER, folder, ignore=shutil.ignore_patterns("*_ws*", ".*"))
    notebook = nbformat.read(path, as_version=4)
    notebook.cells = cells
    nbformat.write(notebook, folder / path.name)
    done = subprocess.run([*NBVAL, path.name], cwd=folder, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout[-6000:] + done.stderr[-2000:]
    assert f"{sum(cell.cell_type == 'code' for cell in cells)} passed" in done.stdout, done.stdout[-2000:]


@pytest.mark.slow("a chapter once more, in parts")
@pytest.mark.timeout(700)
@pytest.mark.parametrize(("path", "resume"), list(resume_cells()))
def test_a_chapter_goes_on_in_a_fresh_kernel_behind_each_place_to_stop(path: Path, resume: str, tmp_path: Path) -> None:
    """As far as the next place, with whose cell the rest goes on in any kernel."""
    cells = nbformat.read(path, as_version=4).cells
    resumes = [number for number, cell in enumerate(cells) if "resume" in cell.metadata.get("tags", [])]
    begin = next(number for number in resumes if cells[number].id == resume)
    end = next((number for number in resumes if number > begin), len(cells))
    cells[begin].metadata.tags = [*cells[begin].metadata.tags, "nbval-ignore-output"]
    run(path, cells[begin:end], tmp_path / "notebooks")


@pytest.mark.slow("a chapter once more")
@pytest.mark.timeout(700)
@pytest.mark.parametrize("path", list(with_optional_sections()))
def test_what_can_be_left_out_is_needed_by_nothing_that_follows(path: Path, tmp_path: Path) -> None:
    kept, leaves_out = [], False
    for cell in nbformat.read(path, as_version=4).cells:
        if cell.source.startswith("## "):
            leaves_out = bool(CAN_BE_LEFT_OUT.match(cell.source))
        if not leaves_out and "resume" not in cell.metadata.get("tags", []):  # which would define what is left out
            kept.append(cell)
    run(path, kept, tmp_path / "notebooks")
