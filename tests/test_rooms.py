"""The rooms of course_kit: which may import which, as pyproject.toml says it; where CONTRIBUTING.md says things are."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from importlinter.cli import EXIT_STATUS_SUCCESS, lint_imports

ROOT = Path(__file__).parents[1]


def test_imports_point_one_way(capsys: pytest.CaptureFixture[str]):
    status = lint_imports(config_filename=str(ROOT / "pyproject.toml"), cache_dir=None, no_cache=True)
    assert status == EXIT_STATUS_SUCCESS, capsys.readouterr().out


def test_files_that_contributing_names_are_there():
    named = re.findall(r"`([a-zA-Z_/]+\.(?:py|xml))`", (ROOT / "CONTRIBUTING.md").read_text())
    files = [str(path) for folder in ("course_kit", "tests") for path in (ROOT / folder).rglob("*.*")]
    assert len(named) > 30
    assert [name for name in named if not any(file.endswith(f"/{name}") for file in files)] == []
