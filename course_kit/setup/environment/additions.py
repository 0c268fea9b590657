"""Packages of a higher level that this environment lacks, and their installation by set-up.

python -m course_kit.setup.environment.additions LEVEL    exit status 1: something is lacking; it is told in one line
"""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

from course_kit.setup.environment import pins, stamp
from course_kit.setup.environment.checks.python import RENEW, STATES
from course_kit.setup.environment.interpreter import applicable

SCRIPT = "environment-check.sh"
WITH_GRADING = f"./{SCRIPT} lab --with-grading"


class NotAdded(ValueError):  # noqa: N818  (reads as what happened)
    """Packages that are lacking could not be installed; the text says why and what to do, unless set-up has."""


def lacking(level: str) -> list[str]:
    """The packages of a level that are not installed here, in whatever version."""
    return [name for name, _ in applicable(pins.added(level)) if not _is_installed(name)]


def _is_installed(name: str) -> bool:
    try:
        distribution(name)
    except PackageNotFoundError:
        return False
    return True


def add(level: str, again: str, root: Path = stamp.ROOT, environ: Mapping[str, str] = os.environ) -> None:
    """Install what this environment lacks of a level, if it lacks anything; `again` is the command to be repeated.

    Raises NotAdded where that cannot be done.
    """
    missing = lacking(level)
    if not missing:
        return
    if obstacle := _obstacle(level, root, environ):
        raise NotAdded(f"{_lacks(missing)}. {obstacle}")
    # Another Python than the one that runs this is no matter here.
    variables = {name: text for name, text in environ.items() if name != "PYTHON"}
    done = subprocess.run(["bash", root / SCRIPT, "--add", level, again], stdin=subprocess.DEVNULL, env=variables)
    if done.returncode:
        raise NotAdded
    importlib.invalidate_caches()
    if missing := lacking(level):
        raise NotAdded(f"{_lacks(missing)}. Somebody has removed that from .venv. In {root}: {RENEW}")


def _lacks(missing: Sequence[str]) -> str:
    more = f" and {len(missing) - 3} more" if len(missing) > 3 else ""
    return f"needed here, but not installed: {', '.join(missing[:3])}{more}"


def _obstacle(level: str, root: Path, environ: Mapping[str, str]) -> str:
    """Why set-up cannot add to this environment, and what to do; empty if it can."""
    venv = root / ".venv"
    state = stamp.state(root, environ, sys.version_info[:2], level)
    is_ours = venv.is_dir() and venv.samefile(sys.prefix)
    if not is_ours or state in (stamp.FOREIGN, stamp.INCOMPLETE):
        return _by_hand(level)
    if state not in (stamp.READY, stamp.BELOW):
        return f"Nothing is added to a .venv that does not fit: {STATES[state]}. In {root}: {WITH_GRADING}"
    if not os.access(venv, os.W_OK):
        return f"{venv} cannot be written. Ask whoever set the course up to run there: {WITH_GRADING}"
    return ""


def _by_hand(level: str) -> str:
    """Return the cure for an environment that set-up has not made."""
    cure = f"{sys.executable} -m pip install -e '.[{level}]'"
    return f"Set-up leaves {sys.prefix} as it is, for it has not made it. In the course's folder: {cure}"


def main(level: str) -> str | None:
    """Tell the script in one line what an environment lacks that it has not made; None if it lacks nothing."""
    missing = lacking(level)
    return f"environment-check: {_lacks(missing)}. {_by_hand(level)}" if missing else None


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
