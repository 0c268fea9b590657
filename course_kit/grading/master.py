"""The course's own notebooks, which hand-ins are rebuilt from: their exercises and cells. Pure: no ROS."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import nbformat

NOTEBOOKS = Path(__file__).parents[2] / "notebooks"
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

    def cell(self, role: str, exercise: str) -> nbformat.NotebookNode:
        """The cell that is the text of an exercise, its answer or its check."""
        wanted = (role, exercise)
        return next(c for c in self.notebook.cells if (mark_of(c).get("role"), mark_of(c).get("exercise")) == wanted)


def mark_of(cell: Any) -> dict[str, Any]:
    """What the course has noted about a cell: its role, its exercise, the points; nothing of most."""
    return dict(cell.get("metadata", {}).get("course_kit", {}))


def chapters(folder: Path = NOTEBOOKS) -> list[Chapter]:
    """The chapters, in order. FileNotFoundError where there are none."""
    found = [Chapter(path) for path in sorted(folder.glob("[0-9][0-9]_*.ipynb"))]
    if not found:
        raise FileNotFoundError(f"the course's own notebooks are not in {folder}: grade in a clone of the course")
    return found


def tasks(only: Sequence[str] = (), in_chapters: Sequence[str] = (), folder: Path = NOTEBOOKS) -> list[Task]:
    """The exercises of these names and chapters, in order; all unless given. ValueError for one that is not there."""
    all_tasks = [task for chapter in chapters(folder) for task in chapter.tasks]
    for wanted, there in ((only, [t.name for t in all_tasks]), (in_chapters, [*{t.chapter: 0 for t in all_tasks}])):
        if unknown := [name for name in wanted if name not in there]:
            raise ValueError(f"there is no {', '.join(unknown)} in the course; there are {', '.join(there)}")
    return [
        task
        for task in all_tasks
        if (not only or task.name in only) and (not in_chapters or task.chapter in in_chapters)
    ]
