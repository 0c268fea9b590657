"""Pictures of each view: live, frozen and as saved, in both themes, at 420 and 1280 px, to be looked at.

`python -m tests.view_pictures FOLDER [KIND ...]` writes KIND-STATE-THEME-WIDTH.png of each, and says where something
is wider than its notebook.
"""

from __future__ import annotations

import os
import signal
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from tests.lab import Lab, lab_on

SET_UP = """
from course_kit import check, plot_graph, plot_pose, record, run
from course_kit import Robot
from course_kit import TurtleSim
from course_kit import show_graph
from course_kit import watch_logs
from course_kit import watch_rates
from course_kit import watch_resources
from course_kit import show_robot
from course_kit import drive
from course_kit import watch_values
turtlesim = run(TurtleSim)
recording = record("/turtle1/pose")
"""
VIEWS = {
    "box": SET_UP,
    "turtle": "panel = drive()",
    "robot": "robot = run(Robot); view = show_robot(robot)",
    "rates": "rates = watch_rates()",
    "values": "values = watch_values('/turtle1/pose.x', '/turtle1/pose.theta')",
    "resources": "resources = watch_resources()",
    "logs": "turtlesim.get_logger().warn('mind the wall'); console = watch_logs()",
    "graph": "graph = show_graph()",
    "form": "from course_kit import show_form; form = show_form('/turtle1/cmd_vel')",
    "ros2": "hz = %ros2 topic hz /turtle1/pose --background",
    "check": "check('setup-2')",
    "figure": "plot_pose(recording)",
    "pid": "import os; os.getpid()",
}
THEMES = {"light": "JupyterLab Light", "dark": "JupyterLab Dark"}
WIDTHS = (1280, 420)
FROZEN = ".jp-NotebookPanel:not(.lm-mod-hidden) .course-kit-frozen"
TOO_WIDE = """id => { const notebook = window.jupyterapp.shell.currentWidget.content;
const cell = notebook.widgets.find(w => w.model.sharedModel.id === id).node;
return [...cell.querySelectorAll('.jp-OutputArea-output, .jp-OutputArea-output *')]
  .filter(e => e.scrollWidth > e.clientWidth + 1 && getComputedStyle(e).overflowX !== 'visible' && e.clientWidth > 1)
  .map(e => `${e.tagName.toLowerCase()}.${e.className}: ${e.scrollWidth} in ${e.clientWidth}`); }"""


def sizes(lab: Lab) -> Iterator[str]:
    """Each theme at each width, by name."""
    for name, theme in THEMES.items():
        lab.page.evaluate("t => window.jupyterapp.commands.execute('apputils:change-theme', {theme: t})", theme)
        for width in WIDTHS:
            lab.page.set_viewport_size({"width": width, "height": 1000})
            lab.page.wait_for_timeout(1500)  # until the page has its new layout and colours
            yield f"{name}-{width}"


def take(lab: Lab, folder: Path, state: str, kinds: list[str]) -> None:
    """Take a picture of each view's output, as it is now."""
    for size in sizes(lab):
        for kind in kinds:
            cell = lab.page.locator(f".jp-CodeCell[data-windowed-list-index='{list(VIEWS).index(kind)}']").first
            cell.scroll_into_view_if_needed()
            output = cell.locator(".jp-Cell-outputWrapper")
            output.screenshot(path=folder / f"{kind}-{state}-{size}.png")
            for wide in lab.page.evaluate(TOO_WIDE, kind):
                print(f"{kind} {state} {size}: {wide}")


def main(folder: Path, kinds: list[str]) -> None:
    """Show all views once, and take their pictures in each state."""
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as made, lab_on(Path(made), "views.ipynb", VIEWS) as lab:
        lab.open("views.ipynb")
        lab.page.evaluate("() => window.jupyterapp.commands.execute('application:toggle-left-area')")
        lab.run_all()
        assert lab.errors() == [], lab.errors()
        lab.page.wait_for_timeout(6000)  # a still of each is kept every 5 s
        take(lab, folder, "live", kinds)
        lab.page.evaluate("() => window.jupyterapp.commands.execute('docmanager:save').then(() => 1)")
        os.kill(int(lab.outputs("pid")[0]["data"]["text/plain"]), signal.SIGKILL)
        lab.page.locator(".jp-Dialog button").first.click(timeout=60_000)
        lab.page.locator(FROZEN).first.wait_for(timeout=30_000)
        take(lab, folder, "frozen", kinds)
        lab.close_notebook()
        lab.open("views.ipynb")
        lab.page.locator(FROZEN).first.wait_for(timeout=60_000)
        take(lab, folder, "saved", kinds)


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:] or [one for one in VIEWS if one != "pid"])
