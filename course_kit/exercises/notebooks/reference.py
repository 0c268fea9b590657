"""The course's own notebooks, which hand-ins are rebuilt from: their exercises and cells. Pure: no ROS.

`python -m course_kit.exercises.notebooks.reference` takes them from notebooks/ after a change there. They are kept
apart, without what grading does not need, because a student's answers stand in those of notebooks/.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import nbformat

from course_kit.base.whole_files import write_whole
from course_kit.exercises.notebooks.definitions import definitions

NOTEBOOKS = Path(__file__).parents[3] / "notebooks"
MASTERS = Path(__file__).with_name("masters")
PATTERN = "[0-9][0-9]_*.ipynb"
EXERCISE, ANSWER, CHECK, PREREQUISITE = "exercise", "answer", "check", "prerequisite"  # what a cell can be


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
    """A chapter's notebook of the course."""

    path: Path

    @cached_property
    def notebook(self) -> nbformat.NotebookNode:
        """The notebook as it is committed."""
        return nbformat.read(self.path, as_version=4)

    @cached_property
    def name(self) -> str:
        """What its exercises begin with, such as "topics"."""
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
    def ids(self) -> frozenset[str]:
        """The ids of all its cells, those too that are not in a master."""
        return frozenset(self.notebook.metadata.get("cells") or [cell.id for cell in self.notebook.cells])

    def cell(self, role: str, exercise: str) -> nbformat.NotebookNode:
        """The cell that is the text of an exercise, its answer or its check."""
        wanted = (role, exercise)
        return next(c for c in self.notebook.cells if (mark_of(c).get("role"), mark_of(c).get("exercise")) == wanted)


def mark_of(cell: Any) -> dict[str, Any]:
    """What the course has noted about a cell: its role, its exercise, the points; nothing of most."""
    return dict(cell.get("metadata", {}).get("course_kit", {}))


def chapters() -> list[Chapter]:
    """The chapters, in order."""
    return [Chapter(path) for path in sorted(MASTERS.glob(PATTERN))]


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
    """What grading needs of a chapter: the marked cells, without outputs."""
    cells = [copy.deepcopy(cell) for cell in notebook.cells if mark_of(cell)]
    for cell in cells:
        if cell.cell_type == "code":
            cell.outputs, cell.execution_count = [], None
    metadata = {"kernelspec": notebook.metadata.kernelspec, "cells": [cell.id for cell in notebook.cells]}
    return nbformat.writes(nbformat.v4.new_notebook(metadata=metadata, cells=cells)) + "\n"


def main() -> None:
    """Take the masters from the chapters."""
    for path in sorted(NOTEBOOKS.glob(PATTERN)):
        write_whole(MASTERS / path.name, stripped(nbformat.read(path, as_version=4)).encode())


if __name__ == "__main__":
    main()
