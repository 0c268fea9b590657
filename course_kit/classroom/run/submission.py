"""The graded part of a hand-in: answers by exercise, and the workspace where a chapter takes one. Pure."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from course_kit.classroom.collect.handins import HandIn
from course_kit.classroom.rebuild import answers_of
from course_kit.exercises.notebooks.reference import ANSWER, CHECK, EXERCISE, PREREQUISITE, Chapter, mark_of

WORKSPACE_CHAPTER = "workspace"


@dataclass(frozen=True)
class Work:
    """One chapter of one student: what a job grades."""

    chapter: str
    sources: Mapping[str, str]  # of answer cells, by exercise
    only: tuple[str, ...]  # the exercises that are asked for
    workspace: Mapping[str, bytes] = field(default_factory=dict)  # files below ros2_ws/src

    def digest(self, chapter: Chapter, course: str) -> str:
        """What tells whether it was graded already: the same answers, by the same course, get the same."""
        marked = [
            (mark["role"], mark.get("exercise"), cell.source)
            for cell in chapter.notebook.cells
            if (mark := mark_of(cell)).get("role") in (EXERCISE, ANSWER, CHECK, PREREQUISITE)
        ]
        files = {path: hashlib.sha256(data).hexdigest() for path, data in self.workspace.items()}
        parts = [course, self.chapter, sorted(self.sources.items()), self.only, sorted(files.items()), marked]
        return hashlib.sha256(json.dumps(parts).encode()).hexdigest()


@dataclass(frozen=True)
class Submission:
    """All that is graded of one student."""

    handin: HandIn
    works: tuple[Work, ...]
    notes: tuple[str, ...]  # those of the hand-in, and what was found when it was read


def read(handin: HandIn, chapters: Sequence[Chapter], only: Sequence[str]) -> Submission:
    """Take the answers to these exercises from a hand-in; whatever was handed in, it raises nothing."""
    works, notes = [], list(handin.notes)
    for chapter in chapters:
        asked = tuple(task.name for task in chapter.tasks if task.name in only)
        if not asked:
            continue
        sources: Mapping[str, str] = {}
        name = chapter.file
        if (data := handin.notebooks.get(name)) is not None:
            answers = answers_of(data, name, chapter)
            sources = answers.sources
            notes += answers.notes
        else:
            notes.append(f"There is no {name}.")
        workspace = handin.workspace if chapter.name == WORKSPACE_CHAPTER else {}
        works.append(Work(chapter.name, sources, asked, workspace))
    return Submission(handin, tuple(works), tuple(notes))
