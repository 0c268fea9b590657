"""The report of the checks: as a table for terminals, as HTML for notebooks and as JSON for programs."""

from __future__ import annotations

import html
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import partial

PASS, WARN, FAIL = "PASS", "WARN", "FAIL"
APT = "sudo apt-get install -y "
ANSI = {PASS: "32", WARN: "33", FAIL: "31"}  # green, yellow, red
# White on these is readable on a light and on a dark page.
BADGE = {PASS: "#2e7d32", WARN: "#a15c00", FAIL: "#c62828"}
LEFT = 'style="text-align:left;vertical-align:top"'
# Beside one another on a wide page, below one another on a narrow one.
NAME = 'style="flex:0 0 13em"'
FOUND = 'style="flex:1 1 15em;overflow-wrap:anywhere"'


@dataclass(frozen=True)
class Check:
    """What one check found; its name comes from the list of checks.

    `reason` says why it matters, `cure` is the command that puts it right.

    Raises ValueError for a WARN or FAIL that does not say both.
    """

    name: str
    status: str
    detail: str
    reason: str = ""
    cure: str = ""

    def __post_init__(self) -> None:
        if self.status != PASS and not (self.reason and self.cure):
            raise ValueError(f"{self.detail!r} is a {self.status} without a reason and a cure")


passed = partial(Check, "", PASS)  # all is as it should be
warn = partial(Check, "", WARN)  # of something that the course can do without
fail = partial(Check, "", FAIL)  # of something that the course needs and does not find


def failed(checks: Sequence[Check]) -> list[Check]:
    """The checks that keep the course from working."""
    return [check for check in checks if check.status == FAIL]


def summary(checks: Sequence[Check]) -> str:
    """One line: how many checks passed, warned and failed."""
    counts = [f"{sum(c.status == status for c in checks)} {status}" for status in (PASS, WARN, FAIL)]
    return f"{len(checks)} checks: {', '.join(counts)}"


def text(checks: Sequence[Check], colour: bool = False) -> str:
    """A table with a line for each check; under a WARN or FAIL the reason and the cure."""
    width = max((len(check.name) for check in checks), default=0)
    lines = []
    for check in checks:
        status = f"\033[{ANSI[check.status]}m{check.status}\033[0m" if colour else check.status
        lines.append(f"{status}  {check.name:<{width}}  {check.detail}")
        if check.status != PASS:
            lines.append(f"{'':<{width + 8}}why:  {check.reason}")
            lines.append(f"{'':<{width + 8}}cure: {check.cure}")
    lines.append(summary(checks))
    if root := for_root(checks):
        lines.append(f"What needs root, in one line: {root}")
    return "\n".join(lines)


def for_root(checks: Sequence[Check]) -> str:
    """One command line with every cure that takes root; empty if there is none."""
    cures = dict.fromkeys(part for check in checks for part in check.cure.split(" && ") if part.startswith("sudo "))
    packages = [word for cure in cures if cure.startswith(APT) for word in cure.removeprefix(APT).split()]
    apt = [f"sudo apt-get update && {APT}{' '.join(dict.fromkeys(packages))}"] if packages else []
    return " && ".join([*apt, *(cure for cure in cures if not cure.startswith(APT))])


def as_json(checks: Sequence[Check]) -> str:
    """{"ok": bool, "root": command, "checks": [{"name", "status", "detail", "reason", "cure"}, ...]}"""
    found = {"ok": not failed(checks), "root": for_root(checks), "checks": [asdict(check) for check in checks]}
    return json.dumps(found, indent=2)


def as_html(checks: Sequence[Check]) -> str:
    """The table for a notebook. Text keeps the page's own colour, so that light and dark themes both work."""
    rows = "".join(
        f"<tr><td {LEFT}>{_badge(check.status)}</td><td {LEFT}><div style='display:flex;flex-wrap:wrap'>"
        f"<span {NAME}>{html.escape(check.name)}</span> <span {FOUND}>{_html_details(check)}</span></div></td></tr>"
        for check in checks
    )
    head = f"<tr><th {LEFT}>result</th><th {LEFT}>check, and what was found</th></tr>"
    table = f'<table style="table-layout:auto"><thead>{head}</thead><tbody>{rows}</tbody></table>'
    return f"{table}<p>{summary(checks)}</p>"


def _badge(status: str) -> str:
    style = f"background:{BADGE[status]};color:#fff;border-radius:3px;padding:1px 6px;font-weight:bold"
    return f'<span style="{style}">{status}</span>'


def _html_details(check: Check) -> str:
    detail, reason, cure = map(html.escape, (check.detail, check.reason, check.cure))
    return detail if check.status == PASS else f"{detail}<br>{reason}<br><code>{cure}</code>"


@dataclass(repr=False)
class Report:
    """Checks as a notebook shows them."""

    checks: Sequence[Check]

    @property
    def failed(self) -> list[Check]:
        """The checks that keep the course from working; empty when all is well."""
        return failed(self.checks)

    def __repr__(self) -> str:
        return text(self.checks)

    def _repr_html_(self) -> str:
        return as_html(self.checks)
