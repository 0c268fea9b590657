"""The chapters as text for tests: their cells in order, their headings with anchors, their prose without code."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import nbformat
from nbformat import NotebookNode

FOLDER = Path(__file__).parents[1] / "notebooks"
PATHS = sorted(FOLDER.glob("[0-9][0-9]_*.ipynb"))
HEADING = re.compile(r"^(#{1,4}) (.+?)\s*$", re.MULTILINE)
FENCED = re.compile(r"^(```|~~~).*?^\1", re.MULTILINE | re.DOTALL)
SPAN = re.compile(r"(?<!`)(`+)(?!`).+?(?<!`)\1(?!`)", re.DOTALL)
TO_GLOSSARY = re.compile(r"\[[^\]]*\]\(glossary\.md[^)]*\)")
TARGET = re.compile(r"(?<=\])\([^)\s]*(?: \"[^\"]*\")?\)")
TAG = re.compile(r"</?[a-zA-Z][^>]*>")
MATHS = re.compile(r"\$\$.+?\$\$|\$[^$\n]+\$", re.DOTALL)
NEXT = re.compile(r"^## Next$.*?(?=^## |\Z)", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class Heading:
    """A heading of a chapter: in which cell, by its number, and where in its text."""

    level: int
    text: str
    cell: int
    offset: int

    @property
    def anchor(self) -> str:
        """What a link to it says behind the #."""
        return anchor(self.text)

    @property
    def place(self) -> tuple[int, int]:
        return self.cell, self.offset


@cache
def cells(path: Path) -> list[NotebookNode]:
    return list(nbformat.read(path, as_version=4).cells)


def tags(cell: NotebookNode) -> list[str]:
    return list(cell.metadata.get("tags", []))


def anchor(heading: str) -> str:
    """JupyterLab's anchor of a heading: its text as shown, with a dash for each space."""
    return re.sub(r"[`*]", "", heading).replace(" ", "-")


def headings(cells: list[NotebookNode]) -> list[Heading]:
    """Those of the Markdown cells, in order."""
    return [
        Heading(len(match[1]), match[2], number, match.start())
        for number, cell in enumerate(cells)
        if cell.cell_type == "markdown"
        for match in HEADING.finditer(blanked(cell.source, FENCED))
    ]


def blanked(text: str, *patterns: re.Pattern[str]) -> str:
    """The text with spaces in place of what matches, so that all else stays where it is."""
    for pattern in patterns:
        text = pattern.sub(lambda match: re.sub(r"\S", " ", match[0]), text)
    return text


def prose(text: str) -> str:
    """What one reads of a Markdown text as sentences: no code, no targets of links, no tags, no Next section."""
    return blanked(text, NEXT, FENCED, SPAN, TO_GLOSSARY, TARGET, TAG, MATHS)


def code_spans(text: str) -> Iterator[tuple[int, str]]:
    """Each piece of code in a Markdown text, and where it begins; none of a Next section."""
    for pattern in (FENCED, SPAN):
        for match in pattern.finditer(blanked(text, NEXT)):
            yield match.start(), match[0]
