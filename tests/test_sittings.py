"""A chapter can be taken in sittings: after a restart from each place to stop, and without what can be left out.

A sitting is the cells from the beginning, or from the resume cell behind a place to stop, to the next resume cell.
"""

from __future__ import annotations

import ast
import re
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import nbformat
import pytest
from IPython.core.inputtransformer2 import TransformerManager

from course_kit.exercises.notebooks.reference import mark_of
from tests.test_notebooks import FOLDER, NBVAL, NOTEBOOKS

CAN_BE_LEFT_OUT = re.compile(r"## .+\n\*.*can be left out\*")


@dataclass(frozen=True)
class Cell:
    """A cell of a chapter, and whether it is in a section that can be left out."""

    cell: nbformat.NotebookNode
    is_resume: bool  # with it a chapter goes on in a fresh kernel
    is_optional: bool  # never true for a resume cell, behind such a section

    @property
    def is_code(self) -> bool:
        return bool(self.cell.cell_type == "code")


def cells_of(path: Path) -> Iterator[Cell]:
    is_optional = False
    for cell in nbformat.read(path, as_version=4).cells:
        is_resume = "resume" in cell.metadata.get("tags", [])
        if cell.source.startswith("## ") or is_resume:
            is_optional = bool(CAN_BE_LEFT_OUT.match(cell.source))
        yield Cell(cell, is_resume, is_optional)


def sittings(path: Path) -> list[list[Cell]]:
    """The cells of each sitting of a chapter."""
    parts: list[list[Cell]] = [[]]
    for cell in cells_of(path):
        if cell.is_resume:
            parts.append([])
        parts[-1].append(cell)
    return parts


def resumed() -> Iterator[Any]:
    """Each sitting that begins with a resume cell."""
    for path in NOTEBOOKS:
        for part in sittings(path)[1:]:
            name = part[0].cell.id
            yield pytest.param(path, part, id=name, marks=pytest.mark.xdist_group(name))


def shorter() -> Iterator[Any]:
    """Each sitting in which other cells follow a section that can be left out, without that."""
    for path in NOTEBOOKS:
        for number, part in enumerate(sittings(path), start=1):
            optional = [cell.is_optional for cell in part if cell.is_code]
            if any(optional) and not all(optional[optional.index(True) :]):
                name = f"{path.stem}-shorter-{number}"
                kept = [cell for cell in part if not cell.is_optional]
                yield pytest.param(path, kept, id=name, marks=pytest.mark.xdist_group(name))


def run(path: Path, sitting: Sequence[Cell], folder: Path) -> None:
    """Run these cells of a chapter under nbval, in the kernel and folder of somebody who has run no other."""
    shutil.copytree(FOLDER, folder, ignore=shutil.ignore_patterns("*_ws*", ".*"))
    notebook = nbformat.read(path, as_version=4)
    notebook.cells = [each.cell for each in sitting]
    if sitting[0].is_resume:
        sitting[0].cell.metadata.tags = [*sitting[0].cell.metadata.tags, "nbval-ignore-output"]
    nbformat.write(notebook, folder / path.name)
    done = subprocess.run([*NBVAL, path.name], cwd=folder, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout[-6000:] + done.stderr[-2000:]
    assert f"{sum(each.is_code for each in sitting)} passed" in done.stdout, done.stdout[-2000:]


@pytest.mark.slow("a chapter once more, in parts")
@pytest.mark.timeout(700)
@pytest.mark.cpu_bound
@pytest.mark.usefixtures("fresh_domain")  # what another test of this process has left would be counted
@pytest.mark.parametrize(("path", "sitting"), list(resumed()))
def test_a_chapter_goes_on_in_a_fresh_kernel_behind_each_place_to_stop(
    path: Path, sitting: list[Cell], tmp_path: Path
) -> None:
    """As far as the next place, with whose cell the rest goes on in any kernel."""
    run(path, sitting, tmp_path / "notebooks")


@pytest.mark.slow("a part of a chapter once more")
@pytest.mark.timeout(700)
@pytest.mark.cpu_bound
@pytest.mark.usefixtures("fresh_domain")
@pytest.mark.parametrize(("path", "sitting"), list(shorter()))
def test_what_can_be_left_out_is_needed_by_nothing_in_its_sitting(
    path: Path, sitting: list[Cell], tmp_path: Path
) -> None:
    """The sittings that follow need nothing that runs before: they go on in a fresh kernel."""
    run(path, sitting, tmp_path / "notebooks")


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_nothing_of_what_can_be_left_out_comes_back_by_catch_up(path: Path) -> None:
    """It would hide that a later sitting needs it: no other cell uses its names, and nothing of it is run again."""
    required: set[str] = set()
    optional: set[str] = set()
    for each in cells_of(path):
        if not each.is_code or each.is_resume:
            continue
        bound, used = names_in(each.cell.source)
        if each.is_optional:
            optional |= bound
            assert mark_of(each.cell).get("part") != "whole", each.cell.id
        else:
            assert not used & optional - required - bound, each.cell.id
            required |= bound


def names_in(source: str) -> tuple[set[str], set[str]]:
    """Names that a cell binds anywhere, and names that it uses."""
    bound, used = set(), set()
    for node in ast.walk(ast.parse(TransformerManager().transform_cell(source))):
        match node:
            case ast.Name(id=name, ctx=ast.Load()):
                used.add(name)
            case ast.Name(id=name) | ast.arg(arg=name) | ast.FunctionDef(name=name) | ast.ClassDef(name=name):
                bound.add(name)
            case ast.alias(name=name, asname=asname):
                bound.add((asname or name).split(".")[0])
    return bound, used
