"""The rooms of course_kit: which may import which, as pyproject.toml says it; where CONTRIBUTING.md says things are."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]


def test_imports_point_one_way():
    # A process of its own, for it switches off all loggers that there are.
    command = [Path(sys.executable).with_name("lint-imports"), "--config", ROOT / "pyproject.toml", "--no-cache"]
    lint = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=100)
    assert lint.returncode == 0, lint.stdout + lint.stderr


def test_files_that_contributing_names_are_there():
    named = re.findall(r"`([a-zA-Z_/]+\.(?:py|xml))`", (ROOT / "CONTRIBUTING.md").read_text())
    files = [str(path) for folder in ("course_kit", "tests") for path in (ROOT / folder).rglob("*.*")]
    assert len(named) > 30
    assert [name for name in named if not any(file.endswith(f"/{name}") for file in files)] == []
