"""The course as a student sees it: JupyterLab in a real browser, the turtle driven by clicks and keys."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbformat.v4 import new_code_cell, new_notebook

from tests.lab import CHROMIUM, Lab, browser, server
from tests.waiting import wait_until

pytestmark = [
    pytest.mark.skipif(CHROMIUM is None, reason="there is no chromium: sudo apt-get install chromium"),
    pytest.mark.timeout(300),
]
NOTEBOOKS = Path(__file__).parents[1] / "notebooks"
CELLS = {
    "start": "from course_kit import record, run\nfrom course_kit.turtlesim import TurtleSim\n"
    "turtlesim = run(TurtleSim)\nrecording = record('/turtle1/pose')",
    "panel": "from course_kit.live.turtle import drive\npanel = drive()\npanel",
    "moved": "float(recording.values('linear_velocity').max()), float(recording.values('angular_velocity').max())",
}


@pytest.fixture(scope="module")
def lab(tmp_path_factory) -> Iterator[Lab]:
    """A lab on a copy of the notebooks, so that the committed ones stay as they are."""
    root = tmp_path_factory.mktemp("notebooks of a student")
    shutil.copytree(NOTEBOOKS, root, dirs_exist_ok=True)
    notebook = new_notebook(cells=[new_code_cell(source, id=name) for name, source in CELLS.items()])
    notebook.metadata["kernelspec"] = {"name": "python3", "display_name": "Python 3", "language": "python"}
    nbformat.write(notebook, root / "drive.ipynb")
    config, profile = tmp_path_factory.mktemp("jupyter"), tmp_path_factory.mktemp("chromium")
    with server(root, config) as address, browser(address, profile) as lab:
        yield lab


@pytest.fixture(autouse=True)
def nothing_is_asked_of_the_network(lab: Lab) -> Iterator[None]:
    yield
    assert lab.outside == []


def until(lab: Lab, condition: Callable[[], Any], timeout: float = 20.0) -> Any:
    """Wait for something outside the page, while the page goes on."""
    return wait_until(condition, timeout=timeout, pause=lambda seconds: lab.page.wait_for_timeout(1000 * seconds))


def speeds(lab: Lab) -> tuple[float, float]:
    """The greatest forward and turning speed that the turtle has had."""
    lab.run_cell("moved")
    forward, turning = lab.outputs("moved")[0]["data"]["text/plain"].strip("()").split(", ")
    return float(forward), float(turning)


def colours(lab: Lab) -> int:
    """How many colours the field on the screen has: one before the turtle is drawn."""
    return lab.page.evaluate(
        "() => { const seen = new Set(); for (const canvas of document.querySelectorAll('.jp-OutputArea canvas')) {"
        "const data = new Uint32Array(canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height)"
        ".data.buffer); for (let i = 0; i < data.length; i += 3) seen.add(data[i]); } return seen.size; }"
    )


def test_the_turtle_is_driven_by_buttons_and_by_keys(lab):
    lab.open("drive.ipynb")
    lab.run_cell("start")
    lab.run_cell("panel")
    field = lab.page.locator(".jp-OutputArea canvas").first
    field.wait_for(timeout=20_000)
    until(lab, lambda: colours(lab) > 5)
    assert speeds(lab) == (0.0, 0.0)

    lab.page.locator("button[title=up]").click()
    until(lab, lambda: speeds(lab) == (2.0, 0.0))
    field.click()
    lab.page.keyboard.press("ArrowLeft")
    until(lab, lambda: speeds(lab) == (2.0, 2.0))
    if folder := os.environ.get("COURSE_SCREENSHOTS"):
        for theme in ("JupyterLab Light", "JupyterLab Dark"):
            lab.page.evaluate("t => window.jupyterapp.commands.execute('apputils:change-theme', {theme: t})", theme)
            lab.page.wait_for_timeout(1500)
            lab.page.screenshot(path=f"{folder}/drive {theme}.png")
    lab.close_notebook()


def test_a_terminal_of_the_lab_has_ros_without_sourcing(lab, tmp_path):
    written = tmp_path / "from the terminal.txt"
    lab.page.evaluate("() => window.jupyterapp.commands.execute('terminal:create-new').then(() => 1)")
    lab.page.wait_for_selector(".jp-Terminal .xterm-helper-textarea", timeout=30_000)
    until(lab, lambda: lab.terminal_text().strip())  # the prompt: what is typed before it may be lost
    lab.page.locator(".jp-Terminal").last.click()
    program = "import os, sys, rclpy; print(sys.prefix, os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'], sep=chr(10))"
    lab.page.keyboard.type(f'python -c "{program}" > "{written}"\n')
    until(lab, lambda: written.exists() and written.read_text().count("\n") == 2, timeout=30)
    expected_range = os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"]
    assert written.read_text().splitlines() == [sys.prefix, expected_range]
    # Tab completes the command, its verb and its option; the answer is the command's.
    lab.page.keyboard.type("ros2 inter\t")
    until(lab, lambda: "ros2 interface " in lab.terminal_text())
    lab.page.keyboard.type("sho\t")
    until(lab, lambda: "ros2 interface show " in lab.terminal_text())
    lab.page.keyboard.type(f'example_interfaces/srv/AddTwoInts > "{written}"\n')
    until(lab, lambda: written.read_text() == "int64 a\nint64 b\n---\nint64 sum\n", timeout=30)


def test_a_request_that_leaves_the_machine_is_noticed(lab):
    lab.page.evaluate("() => fetch('http://192.0.2.1/').catch(() => 0)")  # an address that nobody has
    assert lab.outside == ["http://192.0.2.1/"]
    lab.outside.clear()
