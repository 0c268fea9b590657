"""JupyterLab in a real browser for tests: Debian's chromium, driven by playwright, no request beyond loopback."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import warnings
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import nbformat
from nbformat.v4 import new_code_cell, new_notebook
from playwright.sync_api import Error, Page, sync_playwright

from tests.waiting import wait_until

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
ARGUMENTS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
    "--disable-default-apps",
    "--disable-dev-shm-usage",
]
ADDRESS = re.compile(r"http://127\.0\.0\.1:\d+/lab\?token=\w+")
SOURCES_OF = "window.jupyterapp.shell.currentWidget.content.model.sharedModel.toJSON().cells"


@contextlib.contextmanager
def server(root: Path, config: Path, *arguments: str) -> Iterator[str]:
    """A JupyterLab on a folder; gives its address with the token. What it remembers of its user goes to `config`."""
    command = [sys.executable, "-m", "jupyterlab", "--no-browser", "--ip=127.0.0.1", "--allow-root"]
    # Each kernel's sockets are files: a free port may be taken before a kernel has it, and its page waits for minutes.
    command += ["--expose-app-in-browser", f"--ServerApp.root_dir={root}", "--KernelManager.transport=ipc"]
    # It looks for a free port, frees it, tells it, and then takes it: of two that start at once, both may tell 8888.
    command += ["--ServerApp.port=0"]
    # A short name, for that of a socket has 107 characters at most; a kernel may remove its sockets at the same time.
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as runtime:
        process = subprocess.Popen(
            [*command, *arguments],
            env={"JUPYTER_RUNTIME_DIR": runtime, **os.environ, "JUPYTER_CONFIG_DIR": str(config)},
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        try:
            yield address_of(process)
        finally:
            os.killpg(process.pid, signal.SIGTERM)
            try:
                process.wait(timeout=20)
            except subprocess.TimeoutExpired:  # seen once in hundreds of its starts, on a busy machine
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
                warnings.warn("JupyterLab did not end within 20 s of its SIGTERM, and was killed", stacklevel=1)


def address_of(process: subprocess.Popen[str]) -> str:
    """The address, with the token, of a JupyterLab that has been started, once it listens there."""
    address: list[str] = []
    found = threading.Event()

    def read() -> None:
        assert process.stderr is not None
        for line in process.stderr:  # to the end, so that the server never waits for a reader
            if not address and (match := ADDRESS.search(line)):
                address.append(match[0])
                found.set()

    threading.Thread(target=read, daemon=True).start()
    assert found.wait(60), "JupyterLab did not tell its address within 60 s"
    wait_until(lambda: listens(address[0]))  # it tells the address a moment before
    return address[0]


def listens(address: str) -> bool:
    parts = urlsplit(address)
    with socket.socket() as client:
        return client.connect_ex((parts.hostname, parts.port)) == 0


def until(lab: Lab, condition: Callable[[], Any], timeout: float = 20.0) -> Any:
    """Wait for something outside the page, while the page goes on; return its value."""
    return wait_until(condition, timeout=timeout, pause=lambda seconds: lab.page.wait_for_timeout(1000 * seconds))


class Lab:
    """One browser page with JupyterLab in it."""

    root: Path  # of a lab_on(): where its notebook is

    def __init__(self, page: Page) -> None:
        self.page = page
        self.outside: list[str] = []  # requests that left the machine
        page.on("request", lambda request: self._note(request.url))

    def _note(self, url: str) -> None:
        if not url.startswith(("http://127.0.0.1", "ws://127.0.0.1", "data:", "blob:")):
            self.outside.append(url)

    def open(self, notebook: str) -> None:
        """Open a notebook and wait until its kernel is idle."""
        self.page.evaluate(
            "path => window.jupyterapp.commands.execute('docmanager:open', {path}).then(() => 1)", notebook
        )
        self.page.wait_for_selector(".jp-NotebookPanel:not(.lm-mod-hidden) .jp-CodeCell", timeout=60_000)
        self.page.wait_for_function(
            "() => window.jupyterapp.shell.currentWidget?.sessionContext?.session?.kernel?.status === 'idle'",
            timeout=60_000,
        )

    def open_in_loaded_page(self, notebook: str) -> None:
        """Open a notebook in a page that loads; JupyterLab may load it once more, for a workspace of its own."""

        def is_open() -> bool:
            try:
                self.page.wait_for_function("() => window.jupyterapp?.started.then(() => true)", timeout=120_000)
                self.open(notebook)
            except Error as error:
                if "context was destroyed" not in str(error):
                    raise
                return False
            return True

        until(self, is_open, 120.0)

    def run_all(self, timeout: float = 120.0) -> None:
        """Run every cell and wait for the last one."""
        self.page.evaluate(
            "() => { window.ran = false;"
            "window.jupyterapp.commands.execute('notebook:run-all-cells').then(() => { window.ran = true; }); }"
        )
        self.page.wait_for_function("() => window.ran", timeout=timeout * 1000)

    def run_cell(self, identity: str, timeout: float = 30.0) -> None:
        """Run the cell with an id and wait for it."""
        self.page.evaluate(
            "id => { const notebook = window.jupyterapp.shell.currentWidget.content;"
            "notebook.activeCellIndex = notebook.widgets.findIndex(w => w.model.sharedModel.id === id);"
            "notebook.deselectAll(); window.ran = false;"
            "window.jupyterapp.commands.execute('notebook:run-cell').then(() => { window.ran = true; }); }",
            identity,
        )
        self.page.wait_for_function("() => window.ran", timeout=timeout * 1000)

    def outputs(self, identity: str) -> list[dict[str, Any]]:
        """The outputs of the cell with an id."""
        cells = self.page.evaluate(f"() => {SOURCES_OF}")
        return next(cell.get("outputs", []) for cell in cells if cell.get("id") == identity)

    def errors(self) -> list[str]:
        """The errors that cells of the notebook show."""
        cells = self.page.evaluate(f"() => {SOURCES_OF}")
        return [
            f"{cell['id']}: {output['ename']}: {output['evalue']}"
            for cell in cells
            for output in cell.get("outputs", [])
            if output["output_type"] == "error"
        ]

    def terminal_text(self) -> str:
        """What the terminal in front shows. Taken from xterm's buffer: on the page it is only drawn."""
        return str(
            self.page.evaluate(
                "() => { const buffer = window.jupyterapp.shell.currentWidget.content._term.buffer.active;"
                "let text = ''; for (let row = 0; row < buffer.length; row++) { const line = buffer.getLine(row);"
                "text += (line.isWrapped || row === 0 ? '' : '\\n') + line.translateToString(); } return text; }"
            )
        )

    def close_notebook(self) -> None:
        """End the notebook's kernel and close it without saving."""
        self.page.evaluate(
            "() => window.jupyterapp.shell.currentWidget.sessionContext.shutdown()"
            ".then(() => window.jupyterapp.shell.currentWidget.dispose()).then(() => 1)"
        )


@contextlib.contextmanager
def browser(address: str, profile: Path) -> Iterator[Lab]:
    """JupyterLab opened in a headless chromium with a fresh profile."""
    # The ROS wheels put their libraries on LD_LIBRARY_PATH; the browser brings its own.
    environ: dict[str, str | float | bool] = {k: v for k, v in os.environ.items() if k != "LD_LIBRARY_PATH"}
    with sync_playwright() as playwright:
        context = playwright.chromium.launch_persistent_context(
            profile,
            executable_path=CHROMIUM,
            headless=True,
            env=environ,
            args=ARGUMENTS,
            viewport={"width": 1280, "height": 1000},
        )
        try:
            lab = Lab(context.new_page())
            lab.page.goto(address)
            lab.page.wait_for_function("() => window.jupyterapp", timeout=120_000)
            lab.page.evaluate("() => window.jupyterapp.started.then(() => 1)")
            lab.page.wait_for_selector(".jp-Launcher, .jp-NotebookPanel", timeout=60_000)
            yield lab
        finally:
            context.close()


@contextlib.contextmanager
def lab_on(folder: Path, name: str, cells: Mapping[str, str]) -> Iterator[Lab]:
    """JupyterLab in a browser on one notebook, of these code cells by id; asks nothing of the network."""
    root = folder / "notebooks"
    root.mkdir()
    notebook = new_notebook(cells=[new_code_cell(source.strip(), id=identity) for identity, source in cells.items()])
    notebook.metadata["kernelspec"] = {"name": "python3", "display_name": "Python 3", "language": "python"}
    nbformat.write(notebook, root / name)
    with server(root, folder / "jupyter") as address, browser(address, folder / "chromium") as lab:
        lab.root = root
        yield lab
        assert lab.outside == []
