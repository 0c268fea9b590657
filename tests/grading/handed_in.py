"""Notebooks as students hand them in: the course's own, with answers in their answer cells."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from pathlib import Path

import nbformat

from course_kit.exercises.notebooks.reference import ANSWER, chapters, mark_of
from tests.exercises.chapter import answers_to, preparation

CHAPTERS = {chapter.name: chapter for chapter in chapters()}
# What the tests' answers to an exercise are made with, where they need something besides the chapter.
PREPARED = {name: preparation(name) for name in CHAPTERS}


def notebook(chapter: str, answers: Mapping[str, str]) -> nbformat.NotebookNode:
    """A chapter's notebook with these answers, by exercise."""
    made = copy.deepcopy(CHAPTERS[chapter].notebook)
    for cell in made.cells:
        mark = mark_of(cell)
        if mark.get("role") == ANSWER and mark["exercise"] in answers:
            cell.source = answers[mark["exercise"]]
    return made


def as_bytes(made: nbformat.NotebookNode) -> bytes:
    return nbformat.writes(made).encode()


def hand_in(folder: Path, chapter: str, answers: Mapping[str, str]) -> Path:
    """Put a notebook with these answers into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / CHAPTERS[chapter].file
    path.write_bytes(as_bytes(notebook(chapter, answers)))
    return path


def references(chapter: str) -> dict[str, str]:
    """The reference answers of a chapter, each of which runs by itself."""
    prepared = PREPARED[chapter]
    return {each.exercise: f"{prepared}\n{each.reference}" for each in answers_to(chapter)}
