"""Everything in the source tutorial is taught somewhere: its sections, each item at a cell or in the appendix."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.chapters import FOLDER, HEADING, PATHS, cells

TABLE: list[dict[str, Any]] = yaml.safe_load(Path(__file__).with_name("tutorial_sections.yaml").read_text())
SECTIONS = ["0", "1", "2", "3.1", "3.2", "3.3", "4.1", "4.2", "4.3", "5.1", "5.2", "5.3", "6.1", "6.2", "6.3", "6.4"]
SECTIONS += ["7.1", "7.2", "7.3", "8.1", "8.2", "8.3", "9.1", "9.2", "9.3", "9.4", "10", "11"]
SOURCES = {cell.id: cell.source for path in PATHS for cell in cells(path)}


def appendix() -> dict[str, str]:
    """The sections of the appendix by their headings, without those below them."""
    text = (FOLDER / "machines.md").read_text()
    found = list(HEADING.finditer(text))
    ends = [match.start() for match in found[1:]] + [len(text)]
    return {match[2]: text[match.end() : end] for match, end in zip(found, ends, strict=True)}


def each() -> Iterator[Any]:
    for entry in TABLE:
        yield pytest.param(entry, id=f"{entry['section']} {entry['item']}")


@pytest.mark.parametrize("entry", list(each()))
def test_an_item_of_the_tutorial_stands_in_the_course(entry: dict[str, Any]) -> None:
    places = {cell: SOURCES.get(cell) for cell in entry.get("cells", [])}
    places |= {heading: appendix().get(heading) for heading in entry.get("appendix", [])}
    assert places
    assert [place for place, text in places.items() if text is None] == [], "no such cell, or heading of machines.md"
    assert any(re.search(entry["says"], text or "") for text in places.values()), f"none of them says {entry['says']}"


def test_no_section_of_the_tutorial_is_left_out() -> None:
    assert {entry["section"] for entry in TABLE} == set(SECTIONS)
    assert all(set(entry) <= {"section", "item", "cells", "appendix", "says"} for entry in TABLE)
    items = [(entry["section"], entry["item"]) for entry in TABLE]
    assert len(set(items)) == len(items)
