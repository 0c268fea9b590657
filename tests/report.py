"""The end of a run's report: what was left to another run, what could not be run here, the slowest groups."""

from __future__ import annotations

from collections import Counter
from typing import Any

import pytest

from tests.durations import FIXTURES, Measured

SLOWEST = 10


class Report:
    """A plugin of the process that has the workers: it measures a whole run, and reports at the end."""

    def __init__(self, is_whole: bool) -> None:
        self.is_whole = is_whole
        self.measured = Measured()
        self.not_run: Counter[str] = Counter()  # tests by the reason why they were skipped
        self.left: list[str] = []

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if self.is_whole:
            test, _, group = report.nodeid.rpartition("@")
            self.measured.add(group, test if report.when == "call" else FIXTURES, report.duration)
        if report.skipped and isinstance(report.longrepr, tuple):
            self.not_run[report.longrepr[2].removeprefix("Skipped: ")] += 1

    @pytest.hookimpl(optionalhook=True)
    def pytest_testnodedown(self, node: Any) -> None:
        """Take what a worker says of the choice; each says the same."""
        self.left = getattr(node, "workeroutput", {}).get("left", self.left)

    def pytest_terminal_summary(self, terminalreporter: Any) -> None:
        say = terminalreporter.write_line
        for line in self.left:
            say(line)
        if self.not_run:
            reasons = "; ".join(f"{count}: {reason}" for reason, count in self.not_run.most_common())
            say(f"Not run on this machine: {reasons}.")
        if self.measured.seconds:
            self.measured.keep()
            slowest = [f"{group} {seconds:.0f}" for group, seconds in self.measured.groups()[:SLOWEST]]
            say(f"The slowest groups, in seconds: {', '.join(slowest)}.")
