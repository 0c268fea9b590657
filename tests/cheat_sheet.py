"""The cheat sheet read: its cells are what the tests run; and printed, to count its pages."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import mistune
from playwright.sync_api import sync_playwright

from tests.lab import ARGUMENTS, CHROMIUM

SHEET = Path(__file__).parents[1] / "notebooks/cheat_sheet.md"
COLUMNS = ("notebook", "terminal", "rclpy")
SCALE = 0.52  # as the sheet says
# JupyterLab's preview of Markdown: its fonts, and the edges of its tables.
STYLE = """
body { font: 14px/1.6 system-ui, 'Segoe UI', Helvetica, Arial, sans-serif; margin: 0; padding: 32px }
h1 { font-size: 29px; line-height: 1; margin: 0 0 23px }
p { margin: 0 0 14px }
table { border-collapse: collapse; font-size: 13px; margin: 0 0 13px }
th, td { text-align: left; vertical-align: middle; padding: 6.5px; line-height: normal; border: 1px solid #ccc }
code { font: 14px/1.3 menlo, consolas, 'DejaVu Sans Mono', monospace; padding: 1px 5px; white-space: pre-wrap }
td code { font-size: 13px }
"""


@dataclass(frozen=True)
class Cell:
    """One cell of the sheet: what to do, in which column, and its pieces of code."""

    task: str
    column: str
    text: str

    @property
    def codes(self) -> list[str]:
        return re.findall(r"`([^`]+)`", self.text)


def cells() -> list[Cell]:
    """The cells of the table, row by row."""
    rows = [line.strip("|").split("|") for line in SHEET.read_text().splitlines() if line.startswith("| ")][1:]
    found = []
    for task, *columns in rows:
        found += [
            Cell(task.strip(), column, text.strip())
            for column, text in zip(COLUMNS, columns, strict=True)
            if text.strip()
        ]
    return found


def order_of_looking() -> list[str]:
    """The commands of the last paragraph, in their order."""
    return re.findall(r"`([^`]+)`", SHEET.read_text().split("**Nothing arrives?**")[1])


def pdf() -> bytes:
    """The sheet on A4 in landscape, as a browser prints JupyterLab's preview of it."""
    html = f"<style>{STYLE}</style>{mistune.create_markdown(escape=False, plugins=['table'])(SHEET.read_text())}"
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=CHROMIUM, args=ARGUMENTS)
        page = chromium.new_page()
        page.set_content(html)
        edge = "10mm"
        margins = {"top": edge, "bottom": edge, "left": edge, "right": edge}
        printed = page.pdf(format="A4", landscape=True, scale=SCALE, margin=margins)  # type: ignore[arg-type]
        chromium.close()
    return printed


def pages(printed: bytes) -> int:
    return len(re.findall(rb"/Type\s*/Page\b", printed))
