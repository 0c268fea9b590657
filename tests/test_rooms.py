"""The wings and rooms of course_kit: the imports between them, and the files that pages name."""

from __future__ import annotations

import ast
import importlib
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
KIT = ROOT / "course_kit"
WINGS = ["classroom", "exercises", "views", "cli", "lab", "setup", "robots", "ros", "base"]
OF_THE_EXAMPLE = {f"{package}/exercises/topics/topics_5_echo.py" for package in ("course_kit", "tests")}


def test_imports_point_one_way():
    # A process of its own, for it switches off all loggers that there are.
    command = [Path(sys.executable).with_name("lint-imports"), "--config", ROOT / "pyproject.toml", "--no-cache"]
    lint = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=100)
    assert lint.returncode == 0, lint.stdout + lint.stderr


def test_files_that_the_pages_for_maintainers_name_are_there():
    pages = (ROOT / "CONTRIBUTING.md", *(ROOT / "docs").glob("*.md"))
    text = "".join(page.read_text() for page in pages)
    named = {*re.findall(r"`([a-zA-Z0-9_/]+\.(?:py|xml))`", text)} - OF_THE_EXAMPLE
    files = [str(path) for folder in ("course_kit", "tests") for path in (ROOT / folder).rglob("*.*")]
    assert len(named) > 60
    assert [name for name in named if not any(file.endswith(f"/{name}") for file in files)] == []


def test_course_kit_has_nine_wings_and_nothing_else():
    there = {path.name for path in KIT.iterdir() if path.name != "__pycache__"}
    assert there == {*WINGS, "__init__.py"}


@pytest.mark.parametrize("wing", WINGS)
def test_a_wing_asks_those_that_it_names(wing: str):
    said = re.search(r"It asks ([\w, ]+)", f"{importlib.import_module(f'course_kit.{wing}').__doc__}")
    named = set(re.findall(r"\w+", said[1])) - {"and"} if said else set()
    trees = [ast.parse(path.read_text()) for path in (KIT / wing).rglob("*.py")]
    imports = [node.module for tree in trees for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    modules = [module.split(".") for module in imports if module and module.startswith("course_kit.")]
    assert named == {names[1] for names in modules} - {wing}
