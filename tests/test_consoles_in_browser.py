"""The log console and the live graph in a real browser: chosen by keys, live after a reload, stills at their end."""

from __future__ import annotations

import os
from collections.abc import Iterator
from functools import partial

import pytest
from playwright.sync_api import Locator

from tests.lab import CHROMIUM, Lab, lab_on, until

pytestmark = [
    pytest.mark.cpu_bound,
    pytest.mark.by_turns("a JupyterLab and a browser"),
    pytest.mark.skipif(CHROMIUM is None, reason="there is no chromium: sudo apt-get install chromium"),
    pytest.mark.timeout(300),
]
CELLS = {
    "start": "from course_kit import run, show_graph, watch_logs\n"
    "from rclpy.node import Node\nfrom std_msgs.msg import String\n"
    "class Link(Node):\n    def __init__(self, number):\n        super().__init__(f'link_number_{number}')\n"
    "        self.create_publisher(String, f'/a_long_name_{number}', 10)\n"
    "        self.create_subscription(String, f'/a_long_name_{number + 1}', print, 10)\n"
    "links = [run(Link, number) for number in range(6)]\n"
    "links[0].get_logger().warn('mind the wall')\nlinks[1].get_logger().info('all is well')",
    "logs": "console = watch_logs()",
    "graph": "graph = show_graph()",
    "more": "links[0].get_logger().error('the battery is empty')",
    "another": "run(Node, 'latecomer')",
    "stop": "console.stop(); graph.stop()",
}
PANEL = ".jp-NotebookPanel:not(.lm-mod-hidden)"
LINES = f"{PANEL} .course-kit-logs"
GRAPH = f"{PANEL} .course-kit-view img"
TOO_WIDE = (
    "() => [...document.querySelectorAll('.jp-NotebookPanel:not(.lm-mod-hidden) .jp-OutputArea-output, "
    ".jp-NotebookPanel:not(.lm-mod-hidden) .jp-OutputArea-output *')].filter(e => e.clientWidth > 0 && "
    "e.scrollWidth > e.clientWidth + 1 && getComputedStyle(e).overflowX !== 'visible').map(e => e.className)"
)


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    with lab_on(tmp_path_factory.mktemp("lab"), "consoles.ipynb", CELLS) as lab:
        lab.open("consoles.ipynb")
        lab.page.evaluate("() => window.jupyterapp.shell.collapseLeft()")
        for cell in ("start", "logs", "graph"):
            lab.run_cell(cell)
        assert lab.errors() == []
        yield lab


def lines(lab: Lab) -> str:
    return "\n".join(lab.page.locator(LINES).all_inner_texts())


def level(lab: Lab) -> Locator:
    return lab.page.get_by_label("level", exact=True)


def described(lab: Lab) -> str:
    """What a screen reader says of the graph."""
    return lab.page.locator(GRAPH).first.get_attribute("alt") or ""


def is_narrower(image: Locator, width: int) -> bool:
    return (image.bounding_box() or {"width": 9999})["width"] < width


def test_the_box_of_each_node_of_a_cell_says_that_it_runs(lab: Lab) -> None:
    boxes = lab.page.locator(f"{PANEL} .course-kit-state")
    until(lab, lambda: boxes.all_inner_texts() == [f"▶ /link_number_{number} running" for number in range(6)])


def test_a_wide_graph_and_the_console_fit_into_wide_and_narrow_windows(lab: Lab) -> None:
    until(lab, lambda: "/link_number_5" in described(lab) and "mind the wall" in lines(lab))
    image = lab.page.locator(GRAPH).first
    assert int(image.get_attribute("width") or 0) > 1280
    for width in (1280, 420):
        lab.page.set_viewport_size({"width": width, "height": 1000})
        until(lab, partial(is_narrower, image, width))
        box = image.bounding_box()
        natural = image.evaluate("image => image.naturalWidth / image.naturalHeight")
        assert box and abs(box["width"] / box["height"] - natural) < 0.02 * natural  # whole, not squeezed
        assert lab.page.evaluate(TOO_WIDE) == []
        if folder := os.environ.get("COURSE_SCREENSHOTS"):
            lab.page.screenshot(path=f"{folder}/consoles {width}.png")
    lab.page.set_viewport_size({"width": 1280, "height": 1000})


def test_the_console_is_narrowed_by_keys_alone(lab: Lab) -> None:
    level(lab).focus()
    lab.page.keyboard.press("ArrowDown")
    until(lab, lambda: "mind the wall" in lines(lab) and "all is well" not in lines(lab))
    lab.page.keyboard.press("ArrowUp")
    until(lab, lambda: "all is well" in lines(lab))
    lab.page.keyboard.press("Tab")
    lab.page.keyboard.type("well")  # the next control: a text in the line
    until(lab, lambda: "all is well" in lines(lab) and "mind the wall" not in lines(lab))
    for _ in "well":
        lab.page.keyboard.press("Backspace")
    until(lab, lambda: "mind the wall" in lines(lab))
    # JupyterLab takes R for a raw cell, and Enter for the cell's text.
    level(lab).focus()
    lab.page.keyboard.press("r")
    assert lab.page.locator(f"{PANEL} .jp-RawCell").count() == 0
    assert lab.page.evaluate("() => document.activeElement.tagName") == "SELECT"
    pause = lab.page.get_by_role("button", name="pause")
    pause.focus()
    lab.page.keyboard.press("Enter")
    until(lab, lambda: "mod-active" in (pause.get_attribute("class") or ""))
    lab.page.keyboard.press("Enter")
    until(lab, lambda: "mod-active" not in (pause.get_attribute("class") or ""))


def test_both_are_live_after_a_reload_with_what_was_chosen(lab: Lab) -> None:
    level(lab).select_option("WARN")
    until(lab, lambda: "all is well" not in lines(lab))
    lab.page.evaluate("() => window.jupyterapp.commands.execute('docmanager:save').then(() => 1)")
    lab.page.reload()
    lab.page.wait_for_function("() => window.jupyterapp", timeout=120_000)
    lab.page.evaluate("() => window.jupyterapp.started.then(() => 1)")
    lab.open("consoles.ipynb")
    until(lab, lambda: level(lab).count() == 1)
    assert level(lab).evaluate("select => select.selectedOptions[0].textContent") == "WARN"
    lab.run_cell("more")
    until(lab, lambda: "the battery is empty" in lines(lab) and "all is well" not in lines(lab))
    lab.run_cell("another")
    until(lab, lambda: "/latecomer" in described(lab))


def test_at_their_end_stills_without_controls_stay(lab: Lab) -> None:
    lab.run_cell("stop")
    until(lab, lambda: lab.page.locator(f"{PANEL} .course-kit-note:visible").count() == 2)
    assert lab.page.locator(f"{PANEL} .course-kit-view").locator("button, input, select").count() == 0
    assert "the battery is empty" in lines(lab) and "/latecomer" in described(lab)
