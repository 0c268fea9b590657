"""The start page: it names every chapter with its time, and leads to what there is."""

from __future__ import annotations

import re

import pytest

from course_kit.exercises.catalogue import CHAPTERS
from course_kit.setup.environment.checks.notebook import START
from tests.chapters import FOLDER, PATHS, cells, headings, prose
from tests.test_notebook_edition import stated_time

PAGE = cells(FOLDER / START)
TEXT = "\n".join(cell.source for cell in PAGE if cell.cell_type == "markdown")
ROW = re.compile(r"^\| \[(.+?)\]\((.+?)\) \| .+? \| (\d+) \+ (\d+) \|$", re.MULTILINE)


def test_it_names_the_chapters_in_order_with_their_times():
    chapters = zip(CHAPTERS.values(), PATHS, strict=True)
    expected = [(title, path.name, *map(str, stated_time(path)[:2])) for title, path in chapters]
    assert ROW.findall(TEXT) == expected


def test_each_link_leads_to_a_file():
    files = re.findall(r"\]\(([^)]+)\)", TEXT)
    assert len(files) == len(PATHS) + 3
    assert [name for name in files if not (FOLDER / name).is_file()] == []


@pytest.mark.parametrize("topic", ["run a cell", "have not run", "restart", "help"])
def test_it_says_what_a_beginner_asks_first(topic):
    assert any(topic in heading.text for heading in headings(PAGE))


def test_its_only_code_shows_the_progress():
    assert [cell.source for cell in PAGE if cell.cell_type == "code"] == ["%progress"]
    assert "kernel" in prose(TEXT)
