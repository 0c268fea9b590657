"""The course as a student sees it: JupyterLab in a real browser, its terminal, and no network."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.lab import CHROMIUM, Lab, browser, server, until

pytestmark = [
    pytest.mark.cpu_bound,
    pytest.mark.by_turns("a JupyterLab and a browser"),
    pytest.mark.skipif(CHROMIUM is None, reason="there is no chromium: sudo apt-get install chromium"),
    pytest.mark.timeout(300),
]
NOTEBOOKS = Path(__file__).parents[1] / "notebooks"


@pytest.fixture(scope="module")
def lab(tmp_path_factory) -> Iterator[Lab]:
    """A lab on a copy of the notebooks, so that the committed ones stay as they are."""
    root = tmp_path_factory.mktemp("notebooks of a student")
    shutil.copytree(NOTEBOOKS, root, dirs_exist_ok=True)
    config, profile = tmp_path_factory.mktemp("jupyter"), tmp_path_factory.mktemp("chromium")
    with server(root, config) as address, browser(address, profile) as lab:
        yield lab


@pytest.fixture(autouse=True)
def nothing_is_asked_of_the_network(lab: Lab) -> Iterator[None]:
    yield
    assert lab.outside == []


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
