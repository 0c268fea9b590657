"""The turtle panel in a real browser: keys, clicks and fingers, two tabs, after a reload, in both themes."""

from __future__ import annotations

import contextlib
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
    "start": "from course_kit import record, run, stop\nfrom course_kit import TurtleSim\n"
    "turtlesim = run(TurtleSim)\nrecording = record('/turtle1/pose')",
    "panel": "from course_kit import drive\npanel = drive()\npanel",
    "moved": "float(recording.values('linear_velocity').max()), float(recording.values('angular_velocity').max())",
    "heading": "round(float(recording.values('theta')[-1]), 2)",
    "turtles": "{name: (round(t.x, 1), round(11.09 - t.depth, 1)) for name, t in turtlesim.world.turtles.items()}",
    "close": "panel.close()",
    "stop": "stop()",
}
NOTEBOOK = ".jp-NotebookPanel:not(.lm-mod-hidden) "
PANEL = NOTEBOOK + ".course-kit-turtle"
LOADED = 60.0  # seconds for what two pages of JupyterLab show on a busy machine
A_LITTLE = 0.2  # metres; a key drives for a second, in which a busy simulator ticks 11 of 62 times
FAR = 7.0  # metres: 88 pixels of the trail can be seen then; at 6.6 there are 52
FIELD = PANEL + " .course-kit-turtle-field"
THEMES = ("JupyterLab Light", "JupyterLab Dark")


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    with lab_on(tmp_path_factory.mktemp("lab"), "drive.ipynb", CELLS) as lab:
        yield lab


@pytest.fixture
def panel(lab: Lab) -> Iterator[Lab]:
    """The lab with a panel that shows the turtle."""
    lab.open("drive.ipynb")
    lab.run_cell("start")
    lab.run_cell("panel")
    until(lab, lambda: "turtle1" in told(lab))
    yield lab
    lab.close_notebook()


def told(lab: Lab) -> str:
    """The numbers below the field."""
    return "\n".join(lab.page.locator(PANEL + " .course-kit-turtle-text").all_inner_texts())


def value(lab: Lab, cell: str) -> Any:
    """What a cell gives when it is run; the focus stays where it was."""
    lab.page.evaluate("() => { window.focused = document.activeElement; }")
    lab.run_cell(cell)
    lab.page.evaluate("() => window.focused?.focus({preventScroll: true})")
    return eval(lab.outputs(cell)[0]["data"]["text/plain"])


def colours(lab: Lab) -> dict[str, int]:
    """How many of the field's pixels have which colour."""
    return dict(
        lab.page.evaluate(
            "field => { const canvas = document.querySelector(field + ' canvas'); const seen = {};"
            "const data = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;"
            "for (let i = 0; i < data.length; i += 4) { const key = data.slice(i, i + 3).join(' ');"
            "seen[key] = (seen[key] ?? 0) + 1; } return Object.entries(seen); }",
            FIELD,
        )
    )


def focused(lab: Lab) -> str:
    """What has the keyboard: its label or what stands on it."""
    return str(
        lab.page.evaluate(
            "() => { const one = document.activeElement; return one.getAttribute('aria-label') ?? one.textContent; }"
        )
    )


BLUE, TRAIL = "69 86 255", "179 184 255"


def test_keys_drive_after_a_button_and_do_not_reach_jupyterlab(panel: Lab) -> None:
    cells = panel.page.locator(NOTEBOOK + ".jp-Cell").count()
    panel.page.locator(PANEL + " button.up").click()
    until(panel, lambda: value(panel, "moved") == (2.0, 0.0))
    panel.page.locator(PANEL + " button.up").focus()
    active = panel.page.evaluate("() => window.jupyterapp.shell.currentWidget.content.activeCellIndex")
    panel.page.keyboard.press("ArrowLeft")
    assert panel.page.evaluate("() => window.jupyterapp.shell.currentWidget.content.activeCellIndex") == active
    assert focused(panel) == "up"
    until(panel, lambda: value(panel, "moved") == (2.0, 2.0))
    panel.page.locator(FIELD).click()
    for key in "bbcdvr":  # JupyterLab's: new cell below, copy, delete twice, paste, to raw
        panel.page.keyboard.press(key)
    until(panel, lambda: value(panel, "heading") == pytest.approx(1.57, abs=0.03))
    assert panel.page.locator(NOTEBOOK + ".jp-Cell").count() == cells
    assert panel.page.locator(NOTEBOOK + ".jp-RawCell").count() == 0


def test_tab_reaches_every_control_and_leaves_the_panel(panel: Lab) -> None:
    panel.page.locator(FIELD).focus()
    reached = [focused(panel)]
    for _ in range(10):
        panel.page.keyboard.press("Tab")
        reached.append(focused(panel))
    assert reached[0].startswith("Field of the turtles. Arrow keys drive turtle1")
    assert reached[1:10] == ["up", "left", "down", "right", "Nothing", "Teleport", "Spawn", "Clear", "Reset"]
    assert not panel.page.evaluate("panel => !!document.activeElement.closest(panel)", ".course-kit-turtle")
    panel.page.locator(PANEL + " button.up").focus()
    panel.page.keyboard.press("Shift+Tab")
    assert focused(panel).startswith("Field of the turtles")
    panel.page.keyboard.press("Tab")
    panel.page.keyboard.press("Enter")
    until(panel, lambda: value(panel, "moved") == (2.0, 0.0))


def test_other_keys_go_on_to_jupyterlab(panel: Lab) -> None:
    panel.page.evaluate(
        "() => { window.executed = []; window.jupyterapp.commands.commandExecuted.connect("
        "(_, one) => window.executed.push(one.id)); }"
    )
    panel.page.locator(FIELD).click()
    panel.page.keyboard.press("Control+s")
    until(panel, lambda: "docmanager:save" in panel.page.evaluate("() => window.executed"))
    panel.page.keyboard.press("Control+Enter")
    until(panel, lambda: "notebook:run-cell" in panel.page.evaluate("() => window.executed"))


def test_a_held_button_drives_again_and_again(panel: Lab) -> None:
    panel.page.locator(PANEL + " button.up").hover()
    panel.page.mouse.down()
    until(panel, lambda: x(panel) > 8.5)  # one command is good for 2 m
    panel.page.mouse.up()
    until(panel, lambda: value(panel, "moved") == (2.0, 0.0))


def click_on_the_field(panel: Lab, across: float, down: float) -> None:
    """Click at these parts of its width and height, once it stands still: JupyterLab scrolls to a cell that has run."""
    canvas = panel.page.locator(FIELD + " canvas")
    box = canvas.bounding_box()
    assert box is not None
    canvas.click(position={"x": across * box["width"], "y": down * box["height"]})


def test_a_click_teleports_and_spawns_where_it_was(panel: Lab) -> None:
    click_on_the_field(panel, 0.5, 0.2)
    panel.page.locator(PANEL + " button", has_text="Teleport").click()
    click_on_the_field(panel, 0.25, 0.25)
    until(panel, lambda: value(panel, "turtles") == {"turtle1": (2.8, 8.3)})
    panel.page.locator(PANEL + " button", has_text="Spawn").click()
    click_on_the_field(panel, 0.75, 0.75)
    until(panel, lambda: value(panel, "turtles") == {"turtle1": (2.8, 8.3), "turtle2": (8.3, 2.8)})
    until(panel, lambda: "turtle2  x 8.3" in told(panel))
    assert colours(panel)[TRAIL] > 100
    panel.page.locator(PANEL + " button", has_text="Clear").click()
    until(panel, lambda: TRAIL not in colours(panel))
    panel.page.locator(PANEL + " button", has_text="Reset").click()
    until(panel, lambda: "turtle2" not in told(panel) and "x 5.54" in told(panel))


def test_a_second_tab_and_a_reload_show_the_whole_field(panel: Lab) -> None:
    panel.page.locator(FIELD).click()
    drive(panel)
    until(panel, lambda: colours(panel).get(TRAIL, 0) > 60, LOADED)
    panel.page.evaluate("() => window.jupyterapp.commands.execute('docmanager:save').then(() => 1)")
    page = panel.page.context.new_page()
    page.goto(panel.page.url)
    other = Lab(page)
    other.open_in_loaded_page("drive.ipynb")
    until(other, lambda: x(other) > FAR and x(other) == x(panel), LOADED)
    until(other, lambda: colours(other).get(TRAIL, 0) > 60 and colours(other)[BLUE] > 200_000, LOADED)
    other.page.locator(FIELD).focus()
    far = x(other)
    other.page.keyboard.press("ArrowDown")
    until(other, lambda: x(other) < far - A_LITTLE, LOADED)
    until(panel, lambda: x(panel) < far - A_LITTLE, LOADED)
    page.close()

    panel.page.reload()
    panel.open_in_loaded_page("drive.ipynb")
    until(panel, lambda: 0 < x(panel) < far - A_LITTLE, LOADED)
    until(panel, lambda: colours(panel).get(TRAIL, 0) > 60 and colours(panel)[BLUE] > 200_000, LOADED)
    panel.page.locator(PANEL + " button.left").click()
    until(panel, lambda: "heading 0.00" not in told(panel), LOADED)


def drive(lab: Lab) -> None:
    """Arrow keys until the turtle is far enough for its trail to be seen beside it.

    One is enough for 7.54, but a busy machine may leave out most of the simulator's ticks in the command's second, and
    a key may come before the simulator has found the panel's publisher.
    """
    for _ in range(4):
        lab.page.keyboard.press("ArrowUp")
        with contextlib.suppress(AssertionError):
            until(lab, lambda: x(lab) > FAR, LOADED / 4)
            return
    raise AssertionError(f"the turtle does not move: {told(lab)}")


def x(lab: Lab) -> float:
    """Where the panel says that the first turtle is; 0 before it does."""
    words = told(lab).split()
    return float(words[2]) if "x" in words else 0.0


def test_nothing_that_looks_alive_stays_of_a_closed_panel(panel: Lab) -> None:
    panel.run_cell("close")
    until(panel, lambda: panel.page.locator(PANEL).count() == 0)
    still = panel.page.locator(NOTEBOOK + ".jp-OutputArea img")
    assert still.count() == 1 and still.bounding_box()["width"] == 400  # type: ignore[index]
    assert panel.page.locator(NOTEBOOK + ".jp-OutputArea button:visible").count() == 0


def test_screen_readers_are_told_where_a_turtle_has_come_to_rest(panel: Lab) -> None:
    spoken = panel.page.locator(PANEL + " .course-kit-turtle-spoken")
    until(panel, lambda: "x 5.54" in spoken.inner_text())
    panel.page.evaluate(
        "panel => { window.spoken = 0; new MutationObserver(() => window.spoken++).observe("
        "document.querySelector(panel + ' .course-kit-turtle-spoken'), {childList: true}); }",
        PANEL,
    )
    panel.page.locator(FIELD).focus()
    panel.page.keyboard.press("ArrowUp")
    until(panel, lambda: x(panel) > 5.54 + A_LITTLE and f"x {x(panel):.2f}" in spoken.inner_text())
    assert panel.page.evaluate("() => window.spoken") <= 2
    tree = panel.page.locator(PANEL).aria_snapshot()
    for control in ("up", "left", "down", "right", "Nothing", "Teleport", "Spawn", "Clear", "Reset"):
        assert f'button "{control}"' in tree


def test_a_new_still_behind_the_panel_leaves_the_keyboard_where_it_is(panel: Lab) -> None:
    panel.page.locator(FIELD).click()
    drive(panel)  # a still that comes now was not taken before it drove
    panel.page.evaluate(
        "() => { window.stills = 0; window.focused = document.activeElement; const session = "
        "window.jupyterapp.shell.currentWidget.sessionContext; session.iopubMessage.connect((_, message) => {"
        " if (message.content.data?.['image/png']) window.stills++; }); }"
    )
    until(panel, lambda: panel.page.evaluate("() => window.stills > 0"))
    assert panel.page.evaluate("() => window.focused === document.activeElement && window.focused.isConnected")
    far = x(panel)
    panel.page.keyboard.press("ArrowDown")
    until(panel, lambda: x(panel) < far - A_LITTLE)


def test_axe_finds_nothing(panel: Lab) -> None:
    results = Axe().run(panel.page, context=".course-kit-turtle")
    assert results.violations_count == 0, results.generate_report()


@pytest.mark.parametrize("theme", THEMES)
def test_controls_are_legible_and_nothing_is_cut(panel: Lab, theme: str) -> None:
    panel.page.evaluate("t => window.jupyterapp.commands.execute('apputils:change-theme', {theme: t})", theme)
    light = theme == THEMES[0]
    until(panel, lambda: panel.page.evaluate("() => document.body.dataset.jpThemeLight") == str(light).lower())
    until(panel, lambda: min(contrasts(panel).values()) >= 4.5)  # when the theme's colours have come
    for width in (1280, 420):
        panel.page.set_viewport_size({"width": width, "height": 1000})
        if width == 420 and panel.page.locator("#jp-left-stack").is_visible():
            panel.page.evaluate(
                "() => window.jupyterapp.commands.execute('application:toggle-left-area').then(() => 1)"
            )
        until(panel, lambda: outside(panel) == [])
        screenshot(panel, f"panel {theme[11:]} {width}")
    panel.page.set_viewport_size({"width": 1280, "height": 1000})


def contrasts(lab: Lab) -> dict[str, float]:
    """The contrast of each control's text to its background, of the numbers', and of each border to what is around."""
    return dict(
        lab.page.evaluate(
            """panel => {
              const parts = (text) => text.match(/[\\d.]+/g).map(Number);
              const light = (text) => { const [r, g, b] = parts(text).map((part) => {
                const share = part / 255; return share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
              }); return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
              const ratio = (one, other) => { const [a, b] = [light(one), light(other)];
                return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05); };
              const ground = (node) => { for (; node; node = node.parentElement) {
                const colour = getComputedStyle(node).backgroundColor;
                if (parts(colour)[3] !== 0) return colour; } return 'rgb(255, 255, 255)'; };
              const found = [];
              for (const one of document.querySelectorAll(panel + ' button, ' + panel + ' .course-kit-turtle-text')) {
                const style = getComputedStyle(one);
                found.push([one.textContent, ratio(style.color, ground(one))]);
                if (one.tagName === 'BUTTON')
                  found.push([one.textContent + ' border', ratio(style.borderColor, ground(one.parentElement))]);
              }
              return found;
            }""",
            PANEL,
        )
    )


def outside(lab: Lab) -> list[str]:
    """What of the panel is beyond the edge of the notebook."""
    return list(
        lab.page.evaluate(
            "panel => { const out = []; const edge = document.querySelector(panel).closest('.jp-WindowedPanel-outer, "
            ".jp-NotebookPanel').getBoundingClientRect(); for (const one of document.querySelectorAll("
            "panel + ' button, ' + panel + ' canvas')) { const box = one.getBoundingClientRect();"
            "if (box.left < edge.left || box.right > edge.right || box.width < 20)"
            "out.push(one.textContent || one.tagName); } return out; }",
            PANEL,
        )
    )


def screenshot(lab: Lab, name: str) -> None:
    if folder := os.environ.get("COURSE_SCREENSHOTS"):
        lab.page.locator(PANEL).scroll_into_view_if_needed()
        lab.page.screenshot(path=Path(folder, f"{name}.png"))
