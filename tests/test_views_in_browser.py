"""The base of live views in a real browser: after a reload, a restart, in two tabs, hidden, offline, and as saved."""

from __future__ import annotations

import os
import signal
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
    "start": "from course_kit import run, stop\nfrom course_kit import TurtleSim\nturtlesim = run(TurtleSim)",
    "views": "from course_kit import watch_rates\nfrom course_kit import watch_values\n"
    "rates, values = watch_rates(), watch_values('/turtle1/pose.x')",
    "stop": "rates.stop(); values.stop()",
    "pid": "import os\nos.getpid()",
}
BOXES = ".jp-NotebookPanel:not(.lm-mod-hidden) .course-kit-state"
NOTES = ".jp-NotebookPanel:not(.lm-mod-hidden) .course-kit-note:visible"


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    with lab_on(tmp_path_factory.mktemp("lab"), "views.ipynb", CELLS) as lab:
        yield lab


def text(lab: Lab, selector: str) -> str:
    return "\n".join(lab.page.locator(selector).all_inner_texts())


def notes(lab: Lab) -> list[str]:
    return lab.page.locator(NOTES).all_inner_texts()


def reload(lab: Lab) -> None:
    lab.page.evaluate("() => window.jupyterapp.commands.execute('docmanager:save').then(() => 1)")
    lab.page.reload()
    lab.open_in_loaded_page("views.ipynb")


def rates(lab: Lab) -> str:
    return text(lab, ".jp-NotebookPanel:not(.lm-mod-hidden) .course-kit-live")


def start(lab: Lab) -> None:
    lab.open("views.ipynb")
    lab.run_cell("start")
    lab.run_cell("views")
    until(lab, lambda: "/turtle1/pose" in rates(lab) and "Hz" in rates(lab))


def test_views_are_live_again_after_a_reload_and_frozen_after_a_restart(lab: Lab) -> None:
    start(lab)
    until(lab, lambda: notes(lab) == [])
    reload(lab)
    until(lab, lambda: rates(lab) and notes(lab) == [])
    before = rates(lab)
    until(lab, lambda: rates(lab) != before)
    assert "▶ /turtlesim running" in text(lab, BOXES)

    lab.page.evaluate("() => window.jupyterapp.shell.currentWidget.sessionContext.restartKernel().then(() => 1)")
    until(lab, lambda: text(lab, BOXES) and "running" not in text(lab, BOXES))
    until(lab, lambda: len(notes(lab)) == 2 and all(one.startswith(("Frozen: ", "Stopped: ")) for one in notes(lab)))
    assert "/turtle1/pose" in rates(lab)  # the still stays
    lab.run_cell("start")
    lab.run_cell("views")
    until(lab, lambda: notes(lab) == [] and "▶ /turtlesim running" in text(lab, BOXES))
    lab.close_notebook()


def test_a_kernel_that_is_killed_leaves_frozen_views(lab: Lab) -> None:
    start(lab)
    lab.run_cell("pid")
    os.kill(int(lab.outputs("pid")[0]["data"]["text/plain"]), signal.SIGKILL)
    lab.page.locator(".jp-Dialog button").first.click(timeout=60_000)  # JupyterLab says that it starts another
    until(lab, lambda: "ended with its kernel" in text(lab, BOXES))
    until(lab, lambda: len(notes(lab)) == 2 and all("its kernel has ended" in one for one in notes(lab)))
    lab.close_notebook()


def test_a_notebook_without_its_kernel_shows_frozen_stills(lab: Lab) -> None:
    start(lab)
    lab.page.evaluate("() => window.jupyterapp.commands.execute('docmanager:save').then(() => 1)")
    saved = nbformat.read(lab.root / "views.ipynb", 4)
    (cell,) = [cell for cell in saved.cells if cell.id == "views"]
    assert "Hz" in cell.outputs[0]["data"]["text/plain"] and "image/png" in cell.outputs[1]["data"]
    lab.close_notebook()
    lab.open("views.ipynb")  # with a new kernel
    until(
        lab, lambda: len(notes(lab)) == 2 and all("as it was when the notebook was saved" in one for one in notes(lab))
    )
    assert "saved output" in text(lab, BOXES) and "running" not in text(lab, BOXES).replace("not running", "")
    assert "Hz" in rates(lab)
    lab.close_notebook()


def test_nothing_is_sent_to_a_hidden_notebook(lab: Lab) -> None:
    start(lab)
    lab.page.evaluate("() => window.jupyterapp.commands.execute('launcher:create').then(() => 1)")
    hidden = lab.page.evaluate("() => [...window.jupyterapp.shell.widgets('main')].length")
    assert hidden >= 2
    count_updates(lab)
    until(lab, lambda: lab.page.evaluate("() => Date.now() - window.updated > 3000"))
    lab.page.evaluate(
        "() => { for (const one of window.jupyterapp.shell.widgets('main'))"
        " if (one.context?.path === 'views.ipynb') window.jupyterapp.shell.activateById(one.id); }"
    )
    until(lab, lambda: lab.page.evaluate("() => Date.now() - window.updated < 1000"))
    lab.close_notebook()


def count_updates(lab: Lab) -> None:
    """Have the page note when the notebook's kernel last sent an update."""
    lab.page.evaluate(
        "() => { window.updated = Date.now(); for (const one of window.jupyterapp.shell.widgets('main'))"
        " if (one.context?.path === 'views.ipynb') one.sessionContext.iopubMessage.connect((_, message) => {"
        " if (message.header.msg_type === 'update_display_data') window.updated = Date.now(); }); }"
    )


def test_two_tabs_show_the_same_live_views(lab: Lab) -> None:
    start(lab)
    lab.page.evaluate("() => window.jupyterapp.commands.execute('docmanager:save').then(() => 1)")
    page = lab.page.context.new_page()
    page.goto(lab.page.url)
    other = Lab(page)
    other.open_in_loaded_page("views.ipynb")
    until(other, lambda: rates(other) and notes(other) == [])
    before = rates(other)
    until(other, lambda: rates(other) != before)
    lab.run_cell("stop")
    until(other, lambda: len(notes(other)) == 2 and all(one.startswith("Stopped") for one in notes(other)))
    assert len(notes(lab)) == 2
    page.close()
    lab.close_notebook()


def test_views_go_on_after_the_connection_was_lost(lab: Lab) -> None:
    start(lab)
    lab.page.context.set_offline(True)
    lab.page.evaluate(
        "() => { const kernel = window.jupyterapp.shell.currentWidget.sessionContext.session.kernel;"
        " kernel._ws?.close(); }"
    )
    until(lab, lambda: any(one.startswith("No connection") for one in notes(lab)))
    lab.page.context.set_offline(False)
    until(lab, lambda: notes(lab) == [], 60)
    before = rates(lab)
    until(lab, lambda: rates(lab) != before)
    lab.close_notebook()


def test_run_all_twice_shows_each_view_once(lab: Lab) -> None:
    lab.open("views.ipynb")
    lab.run_all()
    lab.run_all()
    assert lab.errors() == []
    assert lab.page.locator(".jp-NotebookPanel:not(.lm-mod-hidden) .course-kit-view:visible").count() == 3
    assert len(notes(lab)) == 2  # both were stopped by a cell
    lab.close_notebook()
