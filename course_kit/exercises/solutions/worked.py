"""The worked solutions: a Markdown file an exercise in its chapter's folder, the reason and the cells. Pure: no ROS.

A grader hides those folders from a student's code, and a students' edition can be made without them.
"""

from __future__ import annotations

import itertools
import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

EXERCISES, FOLDER = Path(__file__).parents[1], "solutions"  # in the folder of each chapter
CELL = re.compile(r"^```\w+\n(.*?)^```$", re.MULTILINE | re.DOTALL)
FILE = re.compile(r"%%writefile (\S+)\n(.*)", re.DOTALL)


@dataclass(frozen=True)
class Worked:
    """One worked solution."""

    text: str  # as it is shown

    @cached_property
    def cells(self) -> list[str]:
        """The sources of the cells, in order; those of some begin with a magic."""
        return [source.rstrip("\n") for source in CELL.findall(self.text)]

    @property
    def numbered(self) -> str:
        """The text, in which several cells are told apart by their numbers."""
        count, numbers = len(self.cells), itertools.count(1)
        named = CELL.sub(lambda found: f"*Cell {next(numbers)} of {count}*\n\n{found[0]}", self.text)
        return named if count > 1 else self.text

    @property
    def code(self) -> str:
        """The cells that are Python alone."""
        return "\n".join(source for source in self.cells if not source.startswith("%%"))

    @property
    def files(self) -> dict[str, str]:
        """The files that cells write, by their path beside the notebook."""
        return {found[1]: f"{found[2]}\n" for found in map(FILE.fullmatch, self.cells) if found}


def folders() -> list[Path]:
    """Return the folders of the solutions, one a chapter; none in an edition without them."""
    return sorted(EXERCISES.glob(f"*/{FOLDER}"))


def _file(exercise: str) -> Path:
    return EXERCISES / exercise.rpartition("-")[0] / FOLDER / f"{exercise}.md"


def is_there(exercise: str) -> bool:
    """Return True if there is a solution of an exercise here."""
    return _file(exercise).is_file()


def find(exercise: str) -> Worked | None:
    """The solution of an exercise; None in an edition without them, or while it is hidden."""
    try:
        return Worked(_file(exercise).read_text(encoding="utf-8"))
    except OSError:
        return None
