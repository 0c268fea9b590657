"""A student at the keyboard: an exercise answered wrongly, then rightly, by typing, and no request that leaves."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.lab import CHROMIUM, Lab, browser, server

pytestmark = [
    pytest.mark.cpu_bound,
    pytest.mark.by_turns("a JupyterLab and a browser"),
    pytest.mark.skipif(CHROMIUM is None, reason="there is no chromium: sudo apt-get install chromium"),
    pytest.mark.timeout(300),
]
NOTEBOOKS = Path(__file__).parents[1] / "notebooks"
WRONG = """from rclpy.node import Node
from course_kit import check, run

class Greeter(Node):
    def __init__(self):
        super().__init__("greeter")
        self.get_logger().warn("Nice to meet you, Ada")


greeter = run(Greeter)"""


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    root = tmp_path_factory.mktemp("notebooks of a student")
    shutil.copytree(NOTEBOOKS, root, dirs_exist_ok=True)
    config, profile = tmp_path_factory.mktemp("jupyter"), tmp_path_factory.mktemp("chromium")
    with server(root, config) as address, browser(address, profile) as lab:
        yield lab
        assert lab.outside == []


def answer(lab: Lab, cell: str, text: str) -> str:
    """Type an answer into its cell in the place of what is there, run it and the check below; return what that says."""
    lab.page.evaluate(
        "id => { const notebook = window.jupyterapp.shell.currentWidget.content;"
        "notebook.activeCellIndex = notebook.widgets.findIndex(w => w.model.sharedModel.id === id);"
        "return notebook.scrollToItem(notebook.activeCellIndex, 'center').then(() => 1); }",
        cell,
    )
    lab.page.locator(".jp-Cell.jp-mod-active .cm-content:visible").click()
    lab.page.wait_for_selector(".jp-Notebook.jp-mod-editMode .jp-Cell.jp-mod-active .cm-content:focus", timeout=20_000)
    lab.page.keyboard.press("Control+a")
    lab.page.keyboard.insert_text(text)
    typed = "() => window.jupyterapp.shell.currentWidget.content.activeCell.model.sharedModel.source"
    assert lab.page.evaluate(typed) == text
    lab.run_cell(cell)
    check = cell.replace("answer", "check")
    lab.run_cell(check, 60)
    return "\n".join(output["data"]["text/plain"] for output in lab.outputs(check) if "data" in output)


def test_an_exercise_is_solved_by_typing_after_a_wrong_answer(lab: Lab) -> None:
    lab.open("01_setup_checks.ipynb")
    said = answer(lab, "setup-ex2-answer", WRONG)
    assert "1 of 2 points" in said and "the level is not INFO" in said
    assert "2 of 2 points" in answer(lab, "setup-ex2-answer", WRONG.replace(".warn(", ".info("))
    assert lab.errors() == []
