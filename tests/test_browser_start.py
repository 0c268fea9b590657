"""The first minute in a real browser: the address, the start page, the chapters behind its links, what is trusted."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

import nbformat
import pytest
from nbformat.v4 import new_code_cell, new_notebook, new_output

from course_kit.setup.environment.checks.notebook import START
from tests.chapters import FOLDER, PATHS
from tests.lab import CHROMIUM, Lab, browser, server

pytestmark = [
    pytest.mark.cpu_bound,
    pytest.mark.by_turns("a JupyterLab and a browser"),
    pytest.mark.skipif(CHROMIUM is None, reason="there is no chromium: sudo apt-get install chromium"),
    pytest.mark.timeout(600),
]
KERNEL = "ROS 2 Jazzy (course)"
CURRENT = "window.jupyterapp.shell.currentWidget"
STRANGERS = "from a stranger.ipynb"
THEIR_PYTHON = "3.9.0"


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    """A lab on a copy of the notebooks and a stranger's, opened at the address that `lab` prints."""
    root, home = tmp_path_factory.mktemp("notebooks of a student"), tmp_path_factory.mktemp("home")
    shutil.copytree(FOLDER, root, dirs_exist_ok=True, ignore=shutil.ignore_patterns("*_ws*", ".*"))
    output = new_output("display_data", data={"text/html": "<b>theirs</b>"})
    spec = {
        "kernelspec": {"name": "python3", "display_name": KERNEL, "language": "python"},
        "language_info": {"name": "python", "version": THEIR_PYTHON},
    }
    nbformat.write(new_notebook(cells=[new_code_cell("1", outputs=[output])], metadata=spec), root / STRANGERS)
    with pytest.MonkeyPatch.context() as patch, tempfile.TemporaryDirectory() as runtime:
        patch.setenv("JUPYTER_DATA_DIR", str(home / "data"))
        patch.setenv("JUPYTER_RUNTIME_DIR", runtime)
        patch.setenv("XDG_STATE_HOME", str(home / "state"))
        with server(root, home / "config"):
            (announced,) = Path(runtime).glob("jpserver-*.json")
            process = announced.stem.removeprefix("jpserver-")
            command = [sys.executable, "-m", "course_kit.setup.environment.address", process]
            said = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True).stdout
            found = re.search(r"Its address: (\S+)", said)
            assert found, said
            with browser(found[1], home / "profile") as lab:
                yield lab


@pytest.fixture(autouse=True)
def nothing_is_asked_of_the_network(lab: Lab) -> Iterator[None]:
    yield
    assert lab.outside == []


def wait_for_notebook(lab: Lab, name: str) -> None:
    """Until it is in front and its kernel is idle."""
    lab.page.wait_for_function(f"name => {CURRENT}?.context?.path === name", arg=name, timeout=30_000)
    lab.page.wait_for_function(f"() => {CURRENT}.sessionContext?.session?.kernel?.status === 'idle'", timeout=60_000)


def trusted(lab: Lab) -> set[bool]:
    """Of the code cells of the notebook in front."""
    cells = f"{CURRENT}.content.widgets.filter(cell => cell.model.type === 'code')"
    return set(lab.page.evaluate(f"() => {cells}.map(cell => cell.model.trusted)"))


def is_changed(lab: Lab) -> bool:
    """True where the notebook in front has changes that are not saved."""
    return bool(lab.page.evaluate(f"{CURRENT}.context.model.dirty"))


def in_front(lab: Lab, selector: str) -> str:
    """The text of a part of what is in front."""
    return str(lab.page.evaluate(f"selector => {CURRENT}.node.querySelector(selector).textContent", selector))


def test_the_address_opens_the_start_page(lab: Lab):
    assert urlsplit(lab.page.url).path == f"/lab/tree/{START}"
    wait_for_notebook(lab, START)
    assert in_front(lab, "h1").startswith("Start here")
    assert in_front(lab, ".jp-KernelName") == KERNEL


def test_each_chapter_opens_from_its_link_trusted_and_unchanged(lab: Lab):
    titles = []
    for path in PATHS:
        lab.open(START)
        lab.page.locator(f".jp-NotebookPanel:not(.lm-mod-hidden) a[href*='{path.name}']").click()
        wait_for_notebook(lab, path.name)
        titles.append(in_front(lab, "h1")[:4])
        assert in_front(lab, ".jp-KernelName") == KERNEL
        assert trusted(lab) == {True}, path.name
        assert not is_changed(lab), path.name
        lab.close_notebook()
    assert titles == [f"{number} · " for number in range(1, len(PATHS) + 1)]


def test_what_a_stranger_put_in_is_not_trusted(lab: Lab):
    lab.open(STRANGERS)
    assert trusted(lab) == {False}
    lab.close_notebook()


def test_what_another_python_has_saved_is_unchanged_until_it_is_edited(lab: Lab):
    lab.open(STRANGERS)
    version = f"{CURRENT}.context.model.getMetadata('language_info').version"
    lab.page.wait_for_function(f"theirs => {version} !== theirs", arg=THEIR_PYTHON, timeout=60_000)
    assert not is_changed(lab)
    lab.page.evaluate(f"{CURRENT}.content.widgets[0].model.sharedModel.setSource('2')")
    assert is_changed(lab)
    lab.page.evaluate(f"{CURRENT}.context.model.dirty = false")
    lab.close_notebook()


def test_the_appendices_open_as_pages_to_read(lab: Lab):
    lab.open(START)
    lab.page.get_by_role("link", name="Glossary").first.click()
    lab.page.wait_for_selector(".jp-MarkdownViewer:not(.lm-mod-hidden) h1")
    assert in_front(lab, "h1").startswith("Glossary")
    lab.page.evaluate(f"{CURRENT}.dispose()")


def test_the_launcher_and_the_file_browser_show_names_that_can_be_read(lab: Lab):
    lab.page.evaluate("() => window.jupyterapp.commands.execute('launcher:create').then(() => 1)")
    cards = lab.page.locator(".jp-Launcher:not(.lm-mod-hidden) .jp-LauncherCard-label")
    cards.first.wait_for()
    assert cards.all_text_contents()[:2] == [KERNEL, KERNEL]  # of a notebook and of a console
    names = lab.page.evaluate(
        "() => [...document.querySelectorAll('.jp-DirListing-itemText')]"
        ".map(item => [item.textContent, item.scrollWidth <= item.clientWidth])"
    )
    assert {START, *(path.name for path in PATHS)} <= {name for name, _ in names}
    assert [name for name, is_whole in names if not is_whole and name != STRANGERS] == []


@pytest.mark.parametrize("width", [420, 1280])
@pytest.mark.parametrize(
    ("notebook", "cell", "words"),
    [(START, "start-progress", "The course"), (PATHS[0].name, "setup-report", "ROS_DOMAIN_ID")],
)
def test_tables_fit_into_the_page(lab: Lab, notebook: str, cell: str, words: str, width: int):
    lab.page.set_viewport_size({"width": width, "height": 900})
    lab.page.evaluate(f"window.jupyterapp.shell.{'collapse' if width < 800 else 'expand'}Left()")
    lab.open(notebook)
    lab.run_cell(cell)
    output = f".jp-NotebookPanel:not(.lm-mod-hidden) .jp-OutputArea-output:has-text('{words}')"
    lab.page.wait_for_selector(output)
    if folder := os.environ.get("COURSE_SCREENSHOTS"):
        for theme in ("JupyterLab Light", "JupyterLab Dark"):
            lab.page.evaluate("t => window.jupyterapp.commands.execute('apputils:change-theme', {theme: t})", theme)
            lab.page.wait_for_timeout(1500)
            lab.page.screenshot(path=f"{folder}/{cell} {width} {theme}.png")
    sizes = lab.page.eval_on_selector(output, "area => [area.scrollWidth, area.clientWidth]")
    assert sizes[0] <= sizes[1], f"{sizes[0]} px in {sizes[1]} px"
    lab.close_notebook()
