"""`%ros2 … --background` in a real browser: its lines come while cells run, a reload keeps it, its button ends it."""

from __future__ import annotations

import re
from collections.abc import Iterator

import psutil  # type: ignore[import-untyped]
import pytest
from playwright.sync_api import Locator

from tests.lab import CHROMIUM, Lab, lab_on, until
from tests.ros2_launches import none_left

pytestmark = [
    pytest.mark.cpu_bound,
    pytest.mark.by_turns("a JupyterLab and a browser"),
    pytest.mark.skipif(CHROMIUM is None, reason="there is no chromium: sudo apt-get install chromium"),
    pytest.mark.timeout(300),
]
CELLS = {
    "talk": 'talk = %ros2 topic pub -r 20 /chatter std_msgs/msg/String "{data: hello}" --background',
    "measure": "hz = %ros2 topic hz /chatter --background",
    "launch": "launch = %ros2 launch two.launch.py --background",
    "pids": "print('pids', talk.process.pid, hz.process.pid, launch.process.pid)",
    "stop": "from course_kit import stop\nstop()",
}
LAUNCH = """
from launch import LaunchDescription
from launch_ros.actions import Node
def generate_launch_description():
    names = ("one", "two")
    return LaunchDescription([Node(package="turtlesim", executable="turtlesim_node", namespace=n) for n in names])
"""
PANEL = ".jp-NotebookPanel:not(.lm-mod-hidden)"


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    with lab_on(tmp_path_factory.mktemp("lab"), "background.ipynb", CELLS) as lab:
        (lab.root / "two.launch.py").write_text(LAUNCH)
        lab.open("background.ipynb")
        lab.page.evaluate("() => window.jupyterapp.shell.collapseLeft()")
        for cell in ("talk", "measure", "launch", "pids"):
            lab.run_cell(cell)
        assert lab.errors() == []
        yield lab


def view(lab: Lab, cell: str) -> Locator:
    """What stands under a cell."""
    return lab.page.locator(f"{PANEL} .jp-CodeCell").nth(list(CELLS).index(cell)).locator(".jp-Cell-outputWrapper")


def text(lab: Lab, cell: str) -> str:
    return "\n".join(view(lab, cell).locator(".course-kit-console").all_inner_texts())


def numbers(text: str) -> list[int]:
    return [int(number) for number in re.findall(r"publishing #(\d+)", text)]


def test_each_shows_its_newest_lines_while_the_kernel_is_free(lab: Lab) -> None:
    until(lab, lambda: text(lab, "measure").startswith("▶ ros2 topic hz /chatter running"))
    until(lab, lambda: "average rate: " in text(lab, "measure"), 40)
    until(lab, lambda: text(lab, "launch").count("process started with pid") == 2, 40)
    until(lab, lambda: numbers(text(lab, "talk")))
    before = numbers(text(lab, "talk"))
    until(lab, lambda: min(numbers(text(lab, "talk")), default=0) > max(before))


def test_after_a_reload_it_goes_on_and_its_button_ends_it(lab: Lab) -> None:
    lab.page.evaluate("() => window.jupyterapp.commands.execute('docmanager:save').then(() => 1)")
    lab.page.reload()
    lab.open_in_loaded_page("background.ipynb")
    until(lab, lambda: numbers(text(lab, "talk")))
    before = numbers(text(lab, "talk"))
    until(lab, lambda: min(numbers(text(lab, "talk")), default=0) > max(before))
    button = view(lab, "measure").get_by_role("button", name="stop")
    button.focus()
    lab.page.keyboard.press("Enter")  # JupyterLab takes it for the cell's own elsewhere
    until(lab, lambda: text(lab, "measure").startswith("■ ros2 topic hz /chatter stopped"))
    assert "average rate: " in text(lab, "measure")
    until(lab, lambda: button.count() == 0)


def test_stop_ends_it_with_what_it_has_started(lab: Lab) -> None:
    pids = [int(pid) for pid in re.findall(r"\d+", str(lab.outputs("pids")[0]["text"]))]
    family = [*pids, *(child.pid for child in psutil.Process(pids[-1]).children(recursive=True))]
    assert len(family) >= 5
    lab.run_cell("stop", 60)
    until(lab, lambda: none_left(family))
    until(lab, lambda: all(text(lab, cell).startswith("■ ros2 ") for cell in ("talk", "launch")))
    until(lab, lambda: lab.page.get_by_role("button", name="stop", exact=True).count() == 0)
