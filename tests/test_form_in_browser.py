"""A form in a real browser: typed into, with the error beside the field, sent, by the keyboard alone."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import expect

from tests.lab import CHROMIUM, Lab, lab_on, until

pytestmark = [
    pytest.mark.cpu_bound,
    pytest.mark.by_turns("a JupyterLab and a browser"),
    pytest.mark.skipif(CHROMIUM is None, reason="there is no chromium: sudo apt-get install chromium"),
    pytest.mark.timeout(300),
]
CELLS = {
    "start": "from course_kit import record, run, show_form\nfrom course_kit import TurtleSim\n"
    "turtlesim = run(TurtleSim)\nposes = record('/turtle1/pose')",
    "publish": "velocity = show_form('/turtle1/cmd_vel')",
    "call": "spawn = show_form('/spawn')",
    "goal": "turn = show_form('/turtle1/rotate_absolute')",
    "path": "path = show_form('/path', 'nav_msgs/msg/Path')",
    "battery": "battery = show_form('/battery', 'sensor_msgs/msg/BatteryState')",
    "speed": "float(poses.values('linear_velocity').max())",
}
TOO_WIDE = """form => { const right = form.getBoundingClientRect().right + 1;
return [form, ...form.querySelectorAll('*')]
  .filter(e => e.scrollWidth > e.clientWidth + 1 && e.clientWidth > 0 && getComputedStyle(e).display !== 'inline'
    || e.getBoundingClientRect().right > right)
  .map(e => `${e.tagName} ${e.className}: ${e.scrollWidth} in ${e.clientWidth}`); }"""


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    with lab_on(tmp_path_factory.mktemp("lab"), "form.ipynb", CELLS) as lab:
        lab.open("form.ipynb")
        lab.page.evaluate("() => window.jupyterapp.commands.execute('application:toggle-left-area')")
        lab.run_cell("start")
        yield lab


def form(lab: Lab, cell: str) -> Any:
    """The form that a cell shows."""
    lab.run_cell(cell)
    shown = lab.page.locator(f".jp-CodeCell[data-windowed-list-index='{list(CELLS).index(cell)}'] .course-kit-form")
    shown.wait_for(timeout=20_000)
    return shown


def said(form: Any, selector: str) -> str:
    return str(form.locator(selector).inner_text())


def wait_for_status(form: Any, pattern: str) -> None:
    """Wait until the form says how sending goes in words that begin with a pattern."""
    expect(form.get_by_role("status")).to_have_text(re.compile(f"^{pattern}"), timeout=20_000)


def speed(lab: Lab) -> float:
    lab.run_cell("speed")
    return float(lab.outputs("speed")[0]["data"]["text/plain"])


def focused(lab: Lab) -> str:
    """What has the focus within a form: its label, or what stands on it; empty outside."""
    return str(
        lab.page.evaluate(
            "() => { const one = document.activeElement; if (!one?.closest('.course-kit-form')) return '';"
            "const group = one.closest('details')?.querySelector('summary').firstChild.textContent ?? '';"
            "return one.labels?.length ? `${group} ${one.labels[0].firstChild.textContent.trim()}`.trim()"
            " : one.getAttribute('aria-label') ?? one.textContent; }"
        )
    )


def tab_to(lab: Lab, wanted: str, key: str = "Tab") -> None:
    """Press Tab until something in a form has the focus."""
    for _ in range(80):
        lab.page.keyboard.press(key)
        if focused(lab) == wanted:
            return
    raise AssertionError(f"Tab never came to {wanted}")


def retype(lab: Lab, text: str) -> None:
    lab.page.keyboard.press("Control+a")
    lab.page.keyboard.type(text)


def test_a_topic_by_the_keyboard_alone(lab: Lab) -> None:
    velocity = form(lab, "publish")
    tab_to(lab, "linear x")
    retype(lab, "fast")
    alert = velocity.get_by_role("alert").filter(has_text="linear.x takes a float64, a number such as 0.5, not 'fast'.")
    alert.wait_for()
    assert velocity.locator("[aria-invalid=true]").count() == 1
    lab.page.keyboard.press("Enter")
    assert speed(lab) == 0.0
    velocity.locator("input").first.focus()  # running a cell has taken it
    retype(lab, "2")
    lab.page.keyboard.press("Enter")
    wait_for_status(velocity, "1 sent, to 1 subscription$")
    assert velocity.locator("[aria-invalid=true]").count() == 0
    until(lab, lambda: speed(lab) == 2.0)

    velocity.locator("input").first.focus()
    tab_to(lab, "angular z")
    retype(lab, "0.5")
    tab_to(lab, "Rate in Hz")
    retype(lab, "-1")
    velocity.get_by_role("alert").filter(has_text="The rate is a number above 0").wait_for()
    retype(lab, "20")
    tab_to(lab, "Start at", "Shift+Tab")
    lab.page.keyboard.press("Enter")
    wait_for_status(velocity, r"publishing at 20 Hz, [1-9]\d sent, to 1 subscription")
    tab_to(lab, "Stop")
    lab.page.keyboard.press("Space")
    wait_for_status(velocity, "(?!publishing)")
    tab_to(lab, "The same as a command and in Python")
    lab.page.keyboard.press("Enter")
    command = "ros2 topic pub --once /turtle1/cmd_vel geometry_msgs/msg/Twist '{linear: {x: 2.0}, angular: {z: 0.5}}'"
    assert said(velocity, "[aria-label='In a terminal']") == command
    for _ in range(20):  # no trap
        lab.page.keyboard.press("Tab")
        if not focused(lab):
            break
    assert not focused(lab)


def test_keys_of_jupyterlab_stay_its_own_in_a_form(lab: Lab) -> None:
    form(lab, "publish").get_by_role("button", name="Publish once").focus()
    saves = "() => window.jupyterapp.shell.currentWidget.context.saveState.connect((_, s) => { window.saved = s; })"
    lab.page.evaluate(saves)
    lab.page.keyboard.press("Control+s")
    until(lab, lambda: lab.page.evaluate("() => window.saved === 'completed'"))


def test_a_service_is_called_and_its_answer_shown(lab: Lab) -> None:
    spawn = form(lab, "call")
    spawn.get_by_label("name string").fill("leonardo")
    spawn.get_by_role("button", name="Call").click()
    wait_for_status(spawn, "answered after ")
    assert said(spawn, "[aria-label=Answer]") == "name: leonardo"


def test_a_goal_is_followed_and_cancelled(lab: Lab) -> None:
    turn = form(lab, "goal")
    turn.get_by_label("theta float32").fill("3.1")
    turn.get_by_role("button", name="Send goal").click()
    wait_for_status(turn, "EXECUTING")
    assert "remaining: " in said(turn, "[aria-label=Answer]")
    turn.get_by_role("button", name="Cancel goal").click()
    wait_for_status(turn, "CANCELED after ")
    assert "delta: " in said(turn, "[aria-label=Answer]")


def test_elements_are_added_to_an_array_and_removed(lab: Lab) -> None:
    path = form(lab, "path")
    add = path.get_by_role("button", name="Add to poses")
    add.click()
    add.click()
    assert focused(lab) == "[1]  geometry_msgs/PoseStamped".replace("  ", " ")
    path.locator("summary", has_text="[1]").last.press("Enter")
    path.get_by_role("button", name="Remove poses[0]").click()
    assert path.get_by_role("button", name="Remove").count() == 1


def test_a_constant_is_chosen_by_its_name(lab: Lab) -> None:
    battery = form(lab, "battery")
    battery.get_by_label("Constants for power_supply_status").select_option("POWER_SUPPLY_STATUS_FULL")
    battery.locator("summary", has_text="The same as").click()
    until(lab, lambda: said(battery, "[aria-label='In a terminal']").endswith("'{power_supply_status: 4}'"))


def test_what_is_typed_in_is_there_after_a_reload(lab: Lab) -> None:
    spawn = form(lab, "call")
    spawn.get_by_label("x float32").fill("7.5")
    spawn.get_by_label("name string").fill("two words")
    spawn.locator("summary", has_text="The same as").click()
    until(lab, lambda: "two words" in said(spawn, "[aria-label='In a terminal']"))
    lab.page.evaluate("() => window.jupyterapp.commands.execute('docmanager:save').then(() => 1)")
    lab.page.reload()
    lab.page.wait_for_function("() => window.jupyterapp", timeout=120_000)
    lab.page.evaluate("() => window.jupyterapp.started.then(() => 1)")
    lab.open("form.ipynb")
    lab.page.evaluate("() => { window.jupyterapp.shell.currentWidget.content.activeCellIndex = 2; }")
    until(lab, lambda: spawn.count() == 1)
    assert spawn.get_by_label("x float32").input_value() == "7.5"
    assert spawn.get_by_label("name string").input_value() == "two words"
    spawn.get_by_role("button", name="Call").click()
    wait_for_status(spawn, "answered after ")


@pytest.mark.parametrize("theme", ["JupyterLab Light", "JupyterLab Dark"])
@pytest.mark.parametrize("width", [1280, 420])
def test_nothing_is_cut_or_unnamed(lab: Lab, theme: str, width: int) -> None:
    lab.page.evaluate("t => window.jupyterapp.commands.execute('apputils:change-theme', {theme: t})", theme)
    lab.page.set_viewport_size({"width": width, "height": 1000})
    try:
        for cell in ("publish", "call", "goal", "path", "battery"):
            shown = form(lab, cell)
            shown.locator("input").first.fill("fast")
            shown.get_by_role("alert").or_(shown.get_by_role("status")).first.wait_for(state="attached")
            shown.locator("summary", has_text="The same as").click()
            if folder := os.environ.get("COURSE_SCREENSHOTS"):
                lab.page.wait_for_timeout(1500)
                shown.screenshot(path=f"{folder}/form {cell} {theme} {width}.png")
            assert shown.evaluate(TOO_WIDE) == []
            controls = r"^\s*- (textbox|button|checkbox|combobox)(?! \")"
            assert re.findall(controls, shown.aria_snapshot(), re.MULTILINE) == []
    finally:
        lab.page.set_viewport_size({"width": 1280, "height": 1000})
