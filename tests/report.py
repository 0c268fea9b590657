"""The report of a run: each failure at once; at the end the tests left or not run, and the slowest groups."""

from __future__ import annotations

import contextlib
import subprocess
import time
from collections import Counter
from typing import Any

import pytest

from tests.durations import FIXTURES, Measured

SLOWEST = 10
LAST = 25  # lines of a failure that are shown at once; pytest shows it whole at the end of the run


class Report:
    """A plugin of the process that has the workers: it reports, and measures a whole run."""

    def __init__(self, config: pytest.Config, is_whole: bool) -> None:
        self.plugins = config.pluginmanager
        self.is_whole = is_whole
        self.measured = Measured()
        self.not_run: Counter[str] = Counter()  # tests by the reason why they were skipped
        self.left: list[str] = []

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if self.is_whole:
            test, _, group = report.nodeid.rpartition("@")
            self.measured.add(group, test if report.when == "call" else FIXTURES, report.duration)
            if report.failed:
                self.say_at_once(report)
        if report.skipped and isinstance(report.longrepr, tuple):
            self.not_run[report.longrepr[2].removeprefix("Skipped: ")] += 1

    def say_at_once(self, report: pytest.TestReport) -> None:
        """Print the end of a failure: nobody sees the summary of a run that is killed."""
        terminal: Any = self.plugins.get_plugin("terminalreporter")
        say = terminal.write_line
        say(f"\n{time.strftime('%H:%M:%S')} {report.when} of {report.nodeid} failed:")
        for line in report.longreprtext.splitlines()[-LAST:]:
            say(f"    {line}")
        for title, text in report.sections:
            say(f"    {title}:")
            for line in text.splitlines()[-LAST:]:
                say(f"        {line}")

    @pytest.hookimpl(optionalhook=True)
    def pytest_testnodedown(self, node: Any, error: object) -> None:
        """Take what a worker says of the choice, where each says the same; say how one ended in the midst of a test."""
        self.left = getattr(node, "workeroutput", {}).get("left", self.left)
        if error:
            with contextlib.suppress(subprocess.TimeoutExpired):
                status = node.gateway._io.popen.wait(5)  # below zero: the number of a signal
                terminal: Any = self.plugins.get_plugin("terminalreporter")
                terminal.write_line(f"\n{node.gateway.id} ended with {status}")

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
