"""What a view leaves where no kernel is: in the saved notebook, and in the HTML that is exported from it."""

from __future__ import annotations

import re

import nbformat
import pytest
from nbclient import NotebookClient
from nbconvert.exporters import HTMLExporter
from nbformat.v4 import new_code_cell, new_notebook
from traitlets.config import Config

from tests.kernel import own_sockets
from tests.view_pictures import SET_UP, VIEWS

# A part of the text that each leaves, from what it shows.
TEXTS = {
    "turtle": "turtle1",
    "rates": "/turtle1/pose",
    "values": "/turtle1/pose.x",
    "resources": "this notebook",
    "logs": "mind the wall",
    "graph": "/turtlesim",
}
PICTURES = {"turtle", "values", "graph"}


@pytest.fixture(scope="module")
def exported() -> tuple[nbformat.NotebookNode, str]:
    """A notebook that was saved while its views were live, and its HTML."""
    views = ", ".join(f"({VIEWS[kind].split('; ')[-1].split(' = ')[0]}, {text!r})" for kind, text in TEXTS.items())
    wait = (
        "from course_kit import wait_for\n"
        f"for view, text in ({views}):\n    wait_for(lambda: text in view._kept['text/plain'], timeout=30)"
    )
    sources = {"start": SET_UP.strip(), **{kind: VIEWS[kind] for kind in TEXTS}, "wait": wait}
    cells = [new_code_cell(source, id=kind) for kind, source in sources.items()]
    notebook = new_notebook(cells=cells)
    client = NotebookClient(notebook, timeout=60, config=Config({"KernelManager": own_sockets()}))
    with client.setup_kernel():
        for index, cell in enumerate(notebook.cells):
            client.execute_cell(cell, index)
        for _ in range(20):  # what a view sends just as the last cell ends is read with the next one
            if all(TEXTS[cell.id] in str(cell.outputs) for cell in notebook.cells if cell.id in TEXTS):
                break
            client.execute_cell(cell, index)
        saved = nbformat.from_dict(notebook)
    page, _ = HTMLExporter().from_notebook_node(saved)
    return saved, page


@pytest.mark.parametrize("kind", TEXTS)
def test_a_saved_notebook_has_a_text_and_a_still_of_each_view(
    kind: str, exported: tuple[nbformat.NotebookNode, str]
) -> None:
    notebook, _ = exported
    (cell,) = [cell for cell in notebook.cells if cell.id == kind]
    (data,) = [output["data"] for output in cell.outputs if output.get("data", {}).get("text/plain")][-1:]
    assert TEXTS[kind] in data["text/plain"]
    assert "image/png" in data if kind in PICTURES else "text/html" in data


def test_exported_html_shows_the_stills_and_no_widget(exported: tuple[nbformat.NotebookNode, str]) -> None:
    _, page = exported
    assert page.count("data:image/png;base64") >= len(PICTURES)
    for kind in TEXTS.keys() - PICTURES:
        assert TEXTS[kind] in page
    assert not re.search(r"application/vnd\.jupyter\.widget-view|Loading widget", page)
