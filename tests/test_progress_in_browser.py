"""The bar of what takes long in a real browser: it says how far it is, to a screen reader too, and nothing is saved."""

from __future__ import annotations

import os
from collections.abc import Iterator

import nbformat
import pytest

from tests.lab import CHROMIUM, Lab, lab_on, until

pytestmark = [
    pytest.mark.cpu_bound,
    pytest.mark.by_turns("a JupyterLab and a browser"),
    pytest.mark.skipif(CHROMIUM is None, reason="there is no chromium: sudo apt-get install chromium"),
    pytest.mark.timeout(300),
]
CELLS = {
    "start": "import time\nfrom course_kit import wait_for\nfrom course_kit.base.long_tasks import long_task",
    "wait": "import os\ngone = False\nprint('begun')\nwait_for(lambda: os.path.exists('gone'), 300, what='the file')",
    "steps": "with long_task('colcon build', unit='packages') as task:\n    while not os.path.exists('gone'):\n"
    "        time.sleep(0.1)\n    task.done, task.total = 1, 4\n    wait_for(lambda: not os.path.exists('gone'), 300)",
    "end": "wait_for(lambda: False, 60)",
}
BAR = ".jp-NotebookPanel:not(.lm-mod-hidden) [role=progressbar].course-kit-progress"


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    with lab_on(tmp_path_factory.mktemp("lab"), "long.ipynb", CELLS) as lab:
        lab.open("long.ipynb")
        lab.run_cell("start")
        yield lab


def begin(lab: Lab, cell: str) -> None:
    """Run a cell without waiting for its end."""
    lab.page.evaluate(
        "id => { const notebook = window.jupyterapp.shell.currentWidget.content;"
        "notebook.activeCellIndex = notebook.widgets.findIndex(w => w.model.id === id);"
        "window.ran = false;"
        "window.jupyterapp.commands.execute('notebook:run-cell').then(() => { window.ran = true; }); }",
        cell,
    )


def bar(lab: Lab) -> dict[str, str | None]:
    """The bar of the notebook as a screen reader has it; {} if there is none."""
    bars = lab.page.locator(BAR)
    if bars.count() == 0:
        return {}
    return {name: bars.first.get_attribute(f"aria-{name}") for name in ("label", "valuetext", "valuenow")}


def photograph(lab: Lab, name: str) -> None:
    """Keep pictures of both themes and two widths, where they are asked for."""
    if not (folder := os.environ.get("COURSE_SCREENSHOTS")):
        return
    lab.page.evaluate("() => window.jupyterapp.shell.collapseLeft()")
    for theme in ("JupyterLab Dark", "JupyterLab Light"):
        lab.page.evaluate("t => window.jupyterapp.commands.execute('apputils:change-theme', {theme: t})", theme)
        for width in (420, 1280):
            lab.page.set_viewport_size({"width": width, "height": 1000})
            lab.page.wait_for_timeout(1500)
            lab.page.screenshot(path=f"{folder}/{name} {theme} {width}.png")


def test_a_wait_has_a_bar_until_its_end_and_nothing_of_it_is_saved(lab: Lab) -> None:
    begin(lab, "wait")
    until(lab, lambda: bar(lab))
    assert bar(lab)["label"] == "waiting for the file"
    until(lab, lambda: (bar(lab)["valuetext"] or "").endswith(" 4 of at most 300 s"))
    assert bar(lab)["valuenow"] == "1"
    track, filled = (lab.page.locator(f"{BAR} {part}").bounding_box() for part in ("> div", "> div > div"))
    assert track and filled and filled["width"] < 0.05 * track["width"]
    box = lab.page.locator(BAR).bounding_box()
    shown = lab.page.locator(".jp-OutputArea-output", has_text="begun").bounding_box()
    assert box and shown and box["y"] + box["height"] <= shown["y"]  # what is printed does not push it away
    photograph(lab, "wait")
    lab.page.evaluate("() => window.jupyterapp.commands.execute('docmanager:save').then(() => 1)")
    (lab.root / "gone").touch()
    lab.page.wait_for_function("() => window.ran", timeout=20_000)
    assert bar(lab) == {}
    saved = nbformat.read(lab.root / "long.ipynb", 4)
    (cell,) = [cell for cell in saved.cells if cell.id == "wait"]
    assert [output.output_type for output in cell.outputs] == ["stream"]
    assert [output["output_type"] for output in lab.outputs("wait")] == ["stream", "execute_result"]


def test_a_bar_without_a_length_gets_one_when_that_is_known(lab: Lab) -> None:
    (lab.root / "gone").unlink(missing_ok=True)
    begin(lab, "steps")
    until(lab, lambda: bar(lab))
    assert bar(lab)["valuenow"] is None and (bar(lab)["valuetext"] or "").startswith("colcon build: ")
    photograph(lab, "unknown")
    (lab.root / "gone").touch()
    until(lab, lambda: bar(lab)["valuenow"] == "25")
    assert "1 of 4 packages" in (bar(lab)["valuetext"] or "")
    (lab.root / "gone").unlink()
    lab.page.wait_for_function("() => window.ran", timeout=20_000)
    assert bar(lab) == {}


def test_a_kernel_that_is_restarted_takes_the_bar_along(lab: Lab) -> None:
    begin(lab, "end")
    until(lab, lambda: bar(lab))
    lab.page.evaluate("() => window.jupyterapp.shell.currentWidget.sessionContext.restartKernel().then(() => 1)")
    until(lab, lambda: bar(lab) == {})
