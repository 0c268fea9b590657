"""How long dead segments in shared memory hold a program, and what a storm of killed processes leaves."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tests.benchmark.table import Row, at_most
from tests.programs.dead_segments import CASES, in_own_shared_memory

NOTE = (
    "dead_segments: seconds that a program took, start included, with a dead segment in its way: 25 of each kind, the "
    "longest. Then how long a writer stands still whose reader was killed in the midst of a message. Then a storm of "
    "processes that are killed in the first half second of their time in ROS, six at once, beside eight nodes in three "
    "domains: the longest of three new nodes afterwards, pairs of the eight that hear each other no more, processes "
    "that hang. Only root can mount the shared memory that this needs."
)


def rows(quick: bool) -> Iterator[Row]:
    """All rows of this section."""
    count = 3 if quick else 25
    for case in CASES:
        seconds = outcome("tests.programs.dead_segments", case, str(count))
        yield at_most(f"{len(seconds)} of {count}: {case}", "s", max(seconds), 3.0)
    for guard in ("itself", "another"):
        seconds = outcome("tests.programs.endless_recovery", guard, str(2 * count))
        yield at_most(
            f"{len(seconds)} of {2 * count}: a writer whose reader died, guarded by {guard}", "s", max(seconds), 3.0
        )
    storm = outcome("tests.programs.storm", "200" if quick else "3000")
    what = f"a storm of {storm['killed']}"
    yield Row(f"{what}: dead segments that it left", "files", course=storm["dead_segments"])
    yield at_most(f"{what}: a new node afterwards", "s", max(storm["new_node"]), 2.0)
    yield at_most(f"{what}: pairs that hear each other no more", "pairs", len(storm["deaf"]), 0)
    yield at_most(f"{what}: processes that hang", "processes", storm["hanging"], 0)


def outcome(*words: str) -> Any:
    """Run a program in a shared memory of its own; return the JSON that it prints."""
    command = in_own_shared_memory(sys.executable, "-m", *words)
    root = Path(__file__).parents[2]
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE, cwd=root).stdout)
