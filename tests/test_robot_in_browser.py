"""The robot view in a real browser: seen, goals by click, drag and keys, after a reload, in both themes, narrow."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from axe_playwright_python.sync_playwright import Axe  # type: ignore[import-untyped]

from tests.lab import CHROMIUM, Lab, lab_on, until

pytestmark = [
    pytest.mark.cpu_bound,
    pytest.mark.by_turns("a JupyterLab and a browser"),
    pytest.mark.skipif(CHROMIUM is None, reason="there is no chromium: sudo apt-get install chromium"),
    pytest.mark.timeout(300),
]
CELLS = {
    "start": """
import math
from geometry_msgs.msg import PoseStamped, TwistStamped
from rclpy.node import Node
from course_kit import run, show_robot
from course_kit import Robot

class Navigator(Node):
    def __init__(self):
        super().__init__("navigator")
        self.goals, self.linear = [], 0.0
        self.create_subscription(PoseStamped, "/goal_pose", self.goals.append, 10)
        self.commands = self.create_publisher(TwistStamped, "/cmd_vel", 10)
        self.create_timer(0.1, self.drive)

    def drive(self):
        command = TwistStamped()
        command.twist.linear.x = self.linear
        self.commands.publish(command)

robot, navigator = run(Robot, world="empty", start=(1.0, 2.0, 0.0)), run(Navigator)
""",
    "view": "view = show_robot(robot)\nview",
    "goals": "def planar(goal):\n"
    "    turn = goal.pose.orientation\n"
    "    x, y, heading = view._watched[0].topics.robot._origin\n"
    "    assert abs(heading) < 1e-3\n"
    "    return x + goal.pose.position.x, y + goal.pose.position.y, 2 * math.atan2(turn.z, turn.w)\n"
    "[tuple(round(part, 2) for part in planar(goal)) for goal in navigator.goals]",
    "drive": "navigator.linear = 0.2",
    "rest": "navigator.linear = 0.0",
    "stop": "view.stop()",
}
NOTEBOOK = ".jp-NotebookPanel:not(.lm-mod-hidden) "
VIEW = NOTEBOOK + ".course-kit-robot"
FIELD = VIEW + " .course-kit-robot-field"
LOADED = 60.0  # seconds for what a page of JupyterLab shows on a busy machine
THEMES = ("JupyterLab Light", "JupyterLab Dark")
BODY, HIT, WALL, GOAL = "38 92 168", "214 48 49", "74 78 86", "124 58 160"
BOX = (-0.2, -0.2, 6.2, 5.2)  # m, what is shown of the world, to some pixels


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    with lab_on(tmp_path_factory.mktemp("lab"), "robot.ipynb", CELLS) as lab:
        yield lab


@pytest.fixture
def view(lab: Lab) -> Iterator[Lab]:
    """The lab with a view that shows the robot."""
    lab.open("robot.ipynb")
    lab.run_cell("start")
    lab.run_cell("view")
    until(lab, lambda: "robot  x" in told(lab), LOADED)
    yield lab
    lab.close_notebook()


def told(lab: Lab) -> str:
    """The numbers below the picture."""
    return "\n".join(lab.page.locator(VIEW + " .course-kit-robot-text").all_inner_texts())


def said(lab: Lab) -> str:
    """What became of the last goal."""
    return "\n".join(lab.page.locator(VIEW + " .course-kit-robot-said").all_inner_texts())


def x(lab: Lab) -> float:
    """Where the view says that the robot is; 0 before it does."""
    words = told(lab).split()
    return float(words[words.index("x") + 1]) if "x" in words else 0.0


def goals(lab: Lab) -> Any:
    """The goals that a node has got, in the world; the focus stays where it was."""
    lab.page.evaluate("() => { window.focused = document.activeElement; }")
    lab.run_cell("goals")
    lab.page.evaluate("() => window.focused?.focus({preventScroll: true})")
    return eval(lab.outputs("goals")[0]["data"]["text/plain"])


def colours(lab: Lab) -> dict[str, int]:
    """How many of the picture's pixels have which colour; none before it is there."""
    return dict(
        lab.page.evaluate(
            "field => { const canvas = document.querySelector(field + ' canvas'); const seen = {};"
            "if (!canvas?.width) return [];"
            "const data = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;"
            "for (let i = 0; i < data.length; i += 4) { const key = data.slice(i, i + 3).join(' ');"
            "seen[key] = (seen[key] ?? 0) + 1; } return Object.entries(seen); }",
            FIELD,
        )
    )


def pixel(lab: Lab, x: float, y: float) -> tuple[float, float]:
    """Where on the page a place of the world is."""
    lab.page.locator(FIELD).scroll_into_view_if_needed()
    box = lab.page.locator(FIELD + " canvas").bounding_box()
    assert box is not None
    x0, y0, x1, y1 = BOX
    return box["x"] + box["width"] * (x - x0) / (x1 - x0), box["y"] + box["height"] * (y1 - y) / (y1 - y0)


def is_whole(lab: Lab) -> bool:
    """Return True if walls, robot and laser are there."""
    seen = colours(lab)
    return seen.get(WALL, 0) > 1000 and seen.get(BODY, 0) > 50 and seen.get(HIT, 0) > 50


def test_world_robot_and_laser_are_seen_and_what_the_colours_mean(view: Lab) -> None:
    until(view, lambda: is_whole(view), LOADED)
    legend = view.page.locator(VIEW + " .course-kit-robot-legend").inner_text()
    assert "laser" in legend and "robot" in legend and "plan" not in legend
    assert "s simulated" in told(view)


def test_it_is_seen_to_drive_and_screen_readers_are_told_where_it_rests(view: Lab) -> None:
    spoken = view.page.locator(VIEW + " .course-kit-robot-spoken")
    until(view, lambda: "robot x 1.00 m" in spoken.inner_text(), LOADED)
    view.run_cell("drive")
    until(view, lambda: x(view) > 1.3, LOADED)
    view.run_cell("rest")
    until(view, lambda: spoken.inner_text().startswith(f"robot x {x(view):.2f} m"), LOADED)


def test_a_click_sets_a_goal_that_looks_away_from_the_robot(view: Lab) -> None:
    until(view, lambda: is_whole(view), LOADED)
    view.page.mouse.click(*pixel(view, 4.0, 2.0))
    until(view, lambda: goals(view))
    assert goals(view)[0] == pytest.approx((4.0, 2.0, 0.0), abs=0.06)
    until(view, lambda: "on /goal_pose." in said(view))
    until(view, lambda: colours(view).get(GOAL, 0) > 30)
    view.page.locator(VIEW + " button", has_text="Nothing").click()
    view.page.mouse.click(*pixel(view, 2.0, 4.0))
    assert len(goals(view)) == 1


def test_a_drag_turns_the_goal(view: Lab) -> None:
    until(view, lambda: is_whole(view), LOADED)
    view.page.mouse.move(*pixel(view, 3.0, 3.0))
    view.page.mouse.down()
    view.page.mouse.move(*pixel(view, 3.0, 3.5))
    view.page.mouse.move(*pixel(view, 3.0, 4.0))
    view.page.mouse.up()
    until(view, lambda: goals(view))
    assert goals(view)[0] == pytest.approx((3.0, 3.0, 1.57), abs=0.06)


def test_keys_alone_set_a_goal_and_do_not_reach_jupyterlab(view: Lab) -> None:
    until(view, lambda: is_whole(view), LOADED)
    active = view.page.evaluate("() => window.jupyterapp.shell.currentWidget.content.activeCellIndex")
    view.page.locator(FIELD).focus()
    for key in ("ArrowUp", "ArrowUp", "ArrowRight", "Shift+ArrowLeft"):
        view.page.keyboard.press(key)
    spoken = view.page.locator(VIEW + " .course-kit-robot-spoken")
    until(view, lambda: "Cursor x 1.10 m, y 2.20 m, heading 0.26 rad" in spoken.inner_text())
    assert view.page.evaluate("() => window.jupyterapp.shell.currentWidget.content.activeCellIndex") == active
    view.page.keyboard.press("Escape")
    view.page.keyboard.press("ArrowDown")  # from where the robot is again
    view.page.keyboard.press("Enter")
    until(view, lambda: goals(view))
    assert goals(view) == [pytest.approx((1.0, 1.9, 0.0), abs=0.02)]


def test_tab_reaches_every_control_and_leaves_the_view(view: Lab) -> None:
    view.page.locator(FIELD).focus()
    for label in ("Goal", "Nothing"):
        view.page.keyboard.press("Tab")
        assert view.page.evaluate("() => document.activeElement.textContent") == label
    view.page.keyboard.press("Tab")
    assert not view.page.evaluate("() => !!document.activeElement.closest('.course-kit-robot')")


def test_a_reload_shows_all_of_it_again(view: Lab) -> None:
    view.run_cell("drive")
    until(view, lambda: x(view) > 1.3, LOADED)
    view.page.evaluate("() => window.jupyterapp.commands.execute('docmanager:save').then(() => 1)")
    view.page.reload()
    view.open_in_loaded_page("robot.ipynb")
    until(view, lambda: is_whole(view) and x(view) > 1.3, LOADED)
    view.page.mouse.click(*pixel(view, 4.0, 4.0))
    until(view, lambda: goals(view))


def test_a_picture_with_its_text_stays_of_a_stopped_view(view: Lab) -> None:
    view.run_cell("stop")
    until(view, lambda: view.page.locator(VIEW).count() == 0)
    still = view.page.locator(NOTEBOOK + ".jp-OutputArea img")
    assert still.count() == 1
    assert str(still.get_attribute("alt")).startswith("The world empty from above: robot at (1.00, 2.00) m")


def test_axe_finds_nothing(view: Lab) -> None:
    until(view, lambda: is_whole(view), LOADED)
    results = Axe().run(view.page, context=".course-kit-robot")
    assert results.violations_count == 0, results.generate_report()


@pytest.mark.parametrize("theme", THEMES)
def test_nothing_is_cut_in_both_themes_wide_and_narrow(view: Lab, theme: str) -> None:
    view.page.evaluate("t => window.jupyterapp.commands.execute('apputils:change-theme', {theme: t})", theme)
    light = str(theme == THEMES[0]).lower()
    until(view, lambda: view.page.evaluate("() => document.body.dataset.jpThemeLight") == light)
    for width in (1280, 420):
        view.page.set_viewport_size({"width": width, "height": 1000})
        if width == 420 and view.page.locator("#jp-left-stack").is_visible():
            view.page.evaluate("() => window.jupyterapp.commands.execute('application:toggle-left-area').then(() => 1)")
        until(view, lambda: outside(view) == [])
        until(view, lambda: is_whole(view), LOADED)
        screenshot(view, f"robot {theme[11:]} {width}")
    view.page.set_viewport_size({"width": 1280, "height": 1000})


def outside(lab: Lab) -> list[str]:
    """What of the view is beyond the edge of the notebook."""
    return list(
        lab.page.evaluate(
            "view => { const out = []; const edge = document.querySelector(view).closest('.jp-WindowedPanel-outer, "
            ".jp-NotebookPanel').getBoundingClientRect(); for (const one of document.querySelectorAll("
            "view + ' button, ' + view + ' canvas, ' + view + ' span')) { const box = one.getBoundingClientRect();"
            "if (box.left < edge.left || box.right > edge.right) out.push(one.textContent || one.tagName); }"
            "return out; }",
            VIEW,
        )
    )


def screenshot(lab: Lab, name: str) -> None:
    if folder := os.environ.get("COURSE_SCREENSHOTS"):
        lab.page.locator(VIEW).scroll_into_view_if_needed()
        lab.page.screenshot(path=Path(folder, f"{name}.png"))
