"""How long tests take: each run measures it, durations.json has what was kept.

`python -m tests.durations` keeps what the last run measured.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path

KEPT = Path(__file__).with_name("durations.json")
MEASURED = Path(__file__).parents[1] / "build/durations.json"
FIXTURES, OTHERS = "fixtures", "others"  # in the place of a test's name
SHORTEST = 1.0  # seconds of a test that stands by itself in the file
UNKNOWN = 1.0  # seconds of a test of which nothing is known

Seconds = dict[str, dict[str, float]]  # of each group of tests, by the name of a test


class Durations:
    """Seconds that tests took, group by group, with the fixtures of each group."""

    def __init__(self, seconds: Seconds) -> None:
        self.seconds = seconds

    @classmethod
    def read(cls) -> Durations:
        """Read those that runs here have measured, and for other groups those kept. None where there are no files."""
        return cls(_known())

    def of(self, group: str, tests: Iterable[str]) -> float:
        """Seconds that tests of a group take one after another, with their fixtures."""
        known = self.seconds.get(group, {})
        each = known.get(OTHERS, UNKNOWN)
        return known.get(FIXTURES, 0.0) + sum(known.get(test, each) for test in tests)

    def is_long(self, group: str, test: str) -> bool:
        """True for a test that is known to take SHORTEST seconds or more."""
        return self.seconds.get(group, {}).get(test, 0.0) >= SHORTEST

    def of_whole(self, group: str) -> float:
        """Seconds of all tests of a group that were measured."""
        return sum(self.seconds.get(group, {"": UNKNOWN}).values())


def _read(path: Path) -> Seconds:
    return dict(json.loads(path.read_text())) if path.exists() else {}


def _known() -> Seconds:
    """The durations of each group: of the last run here that had it, else those kept."""
    return {**_read(KEPT), **_read(MEASURED)}


def function_of(test: str) -> str:
    """The name of a test's function, which its cases share."""
    return test.partition("[")[0]


class Measured:
    """The durations of one run, test by test."""

    def __init__(self) -> None:
        self.seconds: Seconds = {}

    def add(self, group: str, test: str, seconds: float) -> None:
        tests = self.seconds.setdefault(group, {})
        tests[test] = tests.get(test, 0.0) + seconds

    def groups(self) -> list[tuple[str, float]]:
        """The groups with their seconds, the longest first."""
        sums = {group: sum(tests.values()) for group, tests in self.seconds.items()}
        return sorted(sums.items(), key=lambda each: -each[1])

    def keep(self) -> None:
        """Write them over those of earlier runs; a test that was not run keeps what it had."""
        durations = _known()
        for group, tests in self.seconds.items():
            not_run = {name: seconds for name, seconds in durations.get(group, {}).items() if name not in tests}
            durations[group] = {**not_run, **_short(tests)}
        write(durations, MEASURED)


def _short(tests: dict[str, float]) -> dict[str, float]:
    """The tests that take long, each with its seconds, and the mean of the others, if there are any."""
    long = {name: round(seconds, 1) for name, seconds in tests.items() if seconds >= SHORTEST or name == FIXTURES}
    others = [seconds for name, seconds in tests.items() if name not in long]
    return {**long, OTHERS: round(sum(others) / len(others), 3)} if others else long


def write(seconds: Seconds, path: Path) -> None:
    """Write durations, a test a line, so that a difference can be read."""
    path.parent.mkdir(exist_ok=True)
    path.write_text(json.dumps(seconds, indent=0, sort_keys=True, ensure_ascii=False) + "\n")


if __name__ == "__main__":
    write(_known(), KEPT)
