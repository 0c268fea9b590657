"""The reference notebooks: the chapters as the course has them, without what a student has typed. Pure: no ROS.

In a clone they are the committed ones, for students work in those of notebooks/. A students' edition has copies of the
marked cells. Elsewhere those of notebooks/ serve, and no answer is taken from them.
"""

from __future__ import annotations

import ast
import copy
import functools
import re
import subprocess
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import nbformat

from course_kit.exercises.notebooks.definitions import definitions

ROOT = Path(__file__).parents[3]
EDITION = Path(__file__).with_name("edition")  # the copies in a students' edition
PATTERN = "[0-9][0-9]_*.ipynb"
EXERCISE, ANSWER, CHECK, PREREQUISITE = "exercise", "answer", "check", "prerequisite"  # what a cell can be
GIT_TIMEOUT = 10.0
# A line of an answer cell in which nothing is answered: empty, a comment, or the name of a value.
UNTOUCHED = re.compile(r"\s*(?:#.*)?|\w+ = None\s*(?:#.*)?")


@dataclass(frozen=True)
class Task:
    """One exercise, as its chapter's notebook states it."""

    name: str  # such as "topics-1"
    title: str
    points: int

    @property
    def chapter(self) -> str:
        """Its chapter, such as "topics"."""
        return self.name.rpartition("-")[0]


@dataclass(frozen=True)
class Chapter:
    """The reference notebook of a chapter."""

    file: str  # the name of its file
    text: str

    @cached_property
    def notebook(self) -> nbformat.NotebookNode:
        """Its cells, with their metadata."""
        return nbformat.reads(self.text, as_version=4)

    @cached_property
    def name(self) -> str:
        """The word that its exercises begin with, such as "topics"."""
        return self.tasks[0].chapter

    @cached_property
    def tasks(self) -> tuple[Task, ...]:
        """Its exercises, in order."""
        return tuple(
            Task(mark["exercise"], re.sub(r"### Exercise \d+ · ", "", cell.source.splitlines()[0]), mark["points"])
            for cell in self.notebook.cells
            if (mark := mark_of(cell)).get("role") == EXERCISE
        )

    @cached_property
    def order(self) -> list[str]:
        """The ids of all its cells, from the first to the last, those too that a copy of an edition lacks."""
        return list(self.notebook.metadata.get("cells") or [cell.id for cell in self.notebook.cells])

    @cached_property
    def ids(self) -> frozenset[str]:
        """The ids of all its cells."""
        return frozenset(self.order)

    def cell(self, role: str, exercise: str) -> nbformat.NotebookNode:
        """Return the cell that is the text of an exercise, its answer or its check."""
        wanted = (role, exercise)
        return next(c for c in self.notebook.cells if (mark_of(c).get("role"), mark_of(c).get("exercise")) == wanted)

    def untouched(self, exercise: str) -> str:
        """Return the source of an answer cell in which nothing is answered."""
        own: str = self.cell(ANSWER, exercise).source
        if is_untouched(own):
            return own
        call = ast.parse(self.cell(CHECK, exercise).source).body[-1]
        names = [node.id for node in ast.walk(call) if isinstance(node, ast.Name) and node.id != "check"]
        return "\n".join(f"{name} = None" for name in names)


def is_untouched(source: str) -> bool:
    """Return True if nothing is answered in the source of an answer cell."""
    return all(map(UNTOUCHED.fullmatch, source.splitlines()))


def mark_of(cell: Any) -> dict[str, Any]:
    """Return the course's notes about a cell: its role, its exercise, the points; most cells have none."""
    return dict(cell.get("metadata", {}).get("course_kit", {}))


@functools.cache
def chapters() -> tuple[Chapter, ...]:
    """Return the chapters, in order."""
    if EDITION.is_dir():
        return tuple(Chapter(path.name, path.read_text()) for path in sorted(EDITION.glob(PATTERN)))
    paths = sorted((ROOT / "notebooks").glob(PATTERN))
    return tuple(Chapter(path.name, _committed(path) or path.read_text()) for path in paths)


def _committed(path: Path) -> str:
    """The notebook as git has it; empty where this is no clone, or git is missing or refuses."""
    if not (ROOT / ".git").exists():
        return ""
    command = ["git", "-c", f"safe.directory={ROOT}", "show", f"HEAD:{path.relative_to(ROOT)}"]
    try:
        done = subprocess.run(command, cwd=ROOT, capture_output=True, timeout=GIT_TIMEOUT)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout.decode() if done.returncode == 0 else ""


def tasks(only: Sequence[str] = (), in_chapters: Sequence[str] = ()) -> list[Task]:
    """The exercises of these names and chapters, in order; all unless given. ValueError for one that is not there."""
    all_tasks = [task for chapter in chapters() for task in chapter.tasks]
    for wanted, there in ((only, [t.name for t in all_tasks]), (in_chapters, [*{t.chapter: 0 for t in all_tasks}])):
        if unknown := [name for name in wanted if name not in there]:
            raise ValueError(f"there is no {', '.join(unknown)} in the course; there are {', '.join(there)}")
    return [
        task
        for task in all_tasks
        if (not only or task.name in only) and (not in_chapters or task.chapter in in_chapters)
    ]


def prerequisites(chapter: Chapter) -> Iterator[nbformat.NotebookNode]:
    """Yield the cells that the exercises of a chapter need, whole or their definitions, without its demonstrations."""
    for cell in chapter.notebook.cells:
        mark = mark_of(cell)
        if mark.get("role") == PREREQUISITE:
            kept = copy.deepcopy(cell)
            if mark["part"] == "definitions":
                kept.source = definitions(cell.source)
            yield kept


def stripped(notebook: nbformat.NotebookNode) -> str:
    """Return the text of a notebook with the marked cells of a chapter alone, without outputs."""
    cells = [copy.deepcopy(cell) for cell in notebook.cells if mark_of(cell)]
    for cell in cells:
        if cell.cell_type == "code":
            cell.outputs, cell.execution_count = [], None
    metadata = {"kernelspec": notebook.metadata.kernelspec, "cells": [cell.id for cell in notebook.cells]}
    return nbformat.writes(nbformat.v4.new_notebook(metadata=metadata, cells=cells)) + "\n"
