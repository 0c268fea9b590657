"""The levels of what set-up installs. Each has all of those before it, in the same versions."""

from __future__ import annotations

STUDENT = "student"  # what the notebooks, their checks and `ros2` need: `lab`
GRADING = "grading"  # what `course grade` needs, too: `lab --with-grading`, or the first `course grade`
TEST = "test"  # what checks the course, too: `test`
# The groups of pyproject.toml that each of them adds.
LEVELS = {STUDENT: ("ros", "workspace", "compiler", "notebook"), GRADING: ("grading",), TEST: ("test",)}
DOWNLOADS = {STUDENT: 245, GRADING: 4, TEST: 87}  # MB that each of them adds, the installer included


def up_to(level: str) -> list[str]:
    """A level and those below it, the lowest first. ValueError if there is no such level."""
    names = list(LEVELS)
    return names[: names.index(level) + 1]


def higher(one: str, other: str) -> str:
    """The higher of two levels."""
    return one if other in up_to(one) else other


def download(level: str, there: str = "") -> int:
    """MB that a set-up downloads with nothing in its caches; `there` is the level that it adds to, if there is one."""
    done = up_to(there) if there else []
    return sum(DOWNLOADS[one] for one in up_to(level) if one not in done)
