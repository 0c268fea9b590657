"""The turns of the long tests: each round of five landings runs all parts, in an order that nobody chooses.

A run without --full has a third of the part whose turn it is, which the commit draws, too.

.ci/landed has the commit of each landing, the oldest first. The first commit behind a landing adds it.
"""

from __future__ import annotations

import hashlib
import subprocess
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).parents[1]
LANDED = ROOT / ".ci/landed"
PARTS, THIRDS = 5, 3
SALT = "183710"  # with it the parts take about the same time, and each has one bare system at most
DEALT = 13  # landings before this SALT; a new deal begins a new round
NO_COMMIT = "0"  # of a copy of the course that is no git repository


def git(*words: str) -> list[str]:
    """The lines that git prints; none where it fails."""
    return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True).stdout.splitlines()


def landed() -> list[str]:
    """The commits of the landings, the oldest first."""
    return LANDED.read_text().split()


def commit() -> str:
    """The commit whose turn is drawn: HEAD."""
    return next(iter(git("rev-parse", "HEAD")), NO_COMMIT)


def turn(landings: Sequence[str], commit: str) -> int:
    """The part whose turn it is at a commit behind these landings, which are those since the deal.

    The commit's hash draws it from those that the landings of the same round of five have left.
    """
    left = list(range(PARTS))
    for each in landings[len(landings) // PARTS * PARTS :]:
        left.remove(_drawn(left, each))
    return _drawn(left, commit)


def third(commit: str) -> int:
    """The third of each part that a run of a commit has without --full."""
    return int(commit, 16) // PARTS % THIRDS


def _drawn(left: Sequence[int], commit: str) -> int:
    return left[int(commit, 16) % len(left)]


def part_of(name: str) -> int:
    """The part that a group of tests, or a case, belongs to: by its name alone, so it stays when others come and go."""
    return number_of(name) % PARTS


def third_of(name: str) -> int:
    """The third of its part that a group of tests, or a case, belongs to."""
    return number_of(name) // PARTS % THIRDS


def number_of(name: str) -> int:
    """A number of a name, by which names come in an order that has nothing to do with what they are."""
    return int(hashlib.sha256(f"{SALT} {name}".encode()).hexdigest(), 16)
