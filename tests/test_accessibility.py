"""What is shown under cells, for everybody: axe-core's rules, alternative text, contrast, narrow pages, keys alone."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from importlib import resources
from typing import Any

import pytest

from tests.lab import CHROMIUM, Lab, lab_on, until

pytestmark = [
    pytest.mark.cpu_bound,
    pytest.mark.by_turns("a JupyterLab and a browser"),
    pytest.mark.skipif(CHROMIUM is None, reason="there is no chromium: sudo apt-get install chromium"),
    pytest.mark.timeout(300),
]
AXE = resources.files("axe_playwright_python").joinpath("axe.min.js").read_text()
LOUD = """class Loud(Node):
    def __init__(self):
        super().__init__("loud")
        self.create_publisher(String, "chatter/under/a/name/that/is/rather/long", 10)
        for log in (log_debug, log_info, log_warning, log_error, log_fatal):
            log(self.get_logger())
        self.create_timer(0.5, self.tick)

    def tick(self):
        raise RuntimeError("a callback failed")


loud = run(Loud)
wait_for(lambda: len(logs(level="DEBUG")) >= 6)"""
CELLS = {
    "start": "import os, pathlib\npathlib.Path('pid').write_text(str(os.getpid()))\n"
    "from rclpy.node import Node\nfrom std_msgs.msg import String\n"
    "from course_kit import check, logs, measure_rates, plot_graph, plot_pose, record, run, set_log_level, wait_for\n"
    "from course_kit import TurtleSim\nturtlesim = run(TurtleSim)\n"
    + "\n".join(
        f"log_{level} = lambda logger: (logger.set_level(10), logger.{level}('said at {level}'))"
        for level in ("debug", "info", "warning", "error", "fatal")
    ),
    "console": LOUD,
    "logs": "logs(level='DEBUG')",
    "report": "from course_kit.setup.environment.report import Report, fail, passed, warn\n"
    "named = [('RMW_IMPLEMENTATION', passed('not set: ROS 2 takes its default')),"
    " ('disk', warn('2 GB are free', 'bags may not fit', 'rm -r ~/.cache')),"
    " ('compiler', fail('there is none', 'chapter 2 compiles C++', 'sudo apt-get install -y g++'))]\n"
    "from dataclasses import replace\nReport([replace(check, name=name) for name, check in named])",
    "verdict": "from course_kit.exercises.protocol.verdict import Finding, Verdict\n"
    "found = (Finding('it talks', True, '', 1), Finding('it is `loud`', False, 'Say it `louder`.', 1))\n"
    "Verdict('topics-1', 'A talker', 2, findings=found, seed=4711)",
    "progress": "%progress",
    "rates": "from course_kit import watch_rates\nrates = watch_rates()",
    "resources": "from course_kit import watch_resources\nresources = watch_resources()",
    "values": "from course_kit import watch_values\nvalues = watch_values('/turtle1/pose.x')",
    "log-console": "from course_kit import watch_logs\nconsole = watch_logs()",
    "live-graph": "from course_kit import show_graph\ngraph = show_graph()",
    "form": "from course_kit import show_form\nform = show_form('/turtle1/cmd_vel')",
    "verb": "hz = %ros2 topic hz /turtle1/pose --background",
    "turtle": "from course_kit import drive\npanel = drive()",
    "robot": "from course_kit import show_robot\nfrom course_kit import Robot\nview = show_robot(run(Robot))",
    "figure": "plot_graph()",
    "pose": "plot_pose(record('/turtle1/pose', count=30))",
    "pyplot": "import matplotlib.pyplot as plt\nplt.plot([1, 2])\nplt.title('by hand')\nplt.show()",
    "picture": "turtlesim.picture()",
}
ALTERNATIVE = {
    "values": "/turtle1/pose.x: ",
    "live-graph": "4 nodes, 14 topics, ",
    "figure": "4 nodes, 14 topics, ",
    "pose": "Path of /turtle1/pose: ",
    "pyplot": "by hand, a line with 2 points: ",
    "picture": "The turtles' field: turtle1 at (5.54, 5.54) m",
}
THEMES = ("JupyterLab Light", "JupyterLab Dark")
AA = 4.5
WORDS = {  # at least, in the outputs of a cell
    "console": 5,
    "logs": 5,
    "log-console": 5,
    "form": 8,
    "verb": 2,
    "turtle": 2,
    "robot": 4,
    "verdict": 4,
    "report": 3,
    "rates": 4,
    "progress": 4,
}
CELL = (
    "id => { const notebook = window.jupyterapp.shell.currentWidget.content;"
    "return notebook.widgets.find(one => one.model.sharedModel.id === id); }"
)

# JupyterLab lays out anew a moment after its window or its sidebar has changed. `narrow`: the sidebar is closed.
LAID_OUT = """narrow => {
    const notebook = window.jupyterapp.shell.currentWidget.node.getBoundingClientRect(), edge = window.innerWidth;
    return edge - 60 < notebook.right && notebook.right <= edge && narrow === notebook.left < 60;
}"""


# The contrast of every element's own words with what they stand on, as WCAG 2 defines it: of the colours that the
# browser makes of ours, which a canvas gives as numbers.
CONTRASTS = """outputs => {
    const canvas = new OffscreenCanvas(1, 1).getContext('2d');
    const luminance = (grounds, ink, opacity) => {
        for (const colour of ['#fff', ...grounds]) { canvas.fillStyle = colour; canvas.fillRect(0, 0, 1, 1); }
        canvas.globalAlpha = opacity;
        canvas.fillStyle = ink;
        canvas.fillRect(0, 0, 1, 1);
        canvas.globalAlpha = 1;
        const [r, g, b] = [...canvas.getImageData(0, 0, 1, 1).data].map(one => one / 255)
            .map(one => one <= 0.03928 ? one / 12.92 : ((one + 0.055) / 1.055) ** 2.4);
        return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const up = element => element ? [...up(element.parentElement), getComputedStyle(element)] : [];
    const speaks = one => [...one.childNodes].some(node => node.nodeType === 3 && node.textContent.trim());
    const words = outputs.flatMap(one => [...one.querySelectorAll(':not(style)')]).filter(speaks);
    return words.filter(one => !one.closest(':disabled')).map(one => {
        const styles = up(one), grounds = styles.map(style => style.backgroundColor);
        const opacity = styles.reduce((product, style) => product * style.opacity, 1);
        const paper = luminance(grounds, 'transparent', 1), word = luminance(grounds, styles.at(-1).color, opacity);
        const ratio = (Math.max(paper, word) + 0.05) / (Math.min(paper, word) + 0.05);
        return [one.textContent.trim().slice(0, 40), ratio];
    });
}"""


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    """All that the course shows. Once it is drawn, its kernel stands still: else it would take a processor."""
    with lab_on(tmp_path_factory.mktemp("lab"), "shown.ipynb", CELLS) as lab:
        lab.open("shown.ipynb")
        for name in CELLS:
            lab.run_cell(name, timeout=60)
        assert lab.errors() == []
        until(lab, lambda: all(len(contrasts(lab, name)) >= least for name, least in WORDS.items()))
        until(lab, lambda: all(alternatives(lab, name) for name in ALTERNATIVE))
        lab.page.evaluate(AXE)
        kernel = int((lab.root / "pid").read_text())
        os.kill(kernel, signal.SIGSTOP)
        yield lab
        os.kill(kernel, signal.SIGCONT)


@pytest.fixture(scope="module", params=THEMES)
def themed(lab: Lab, request: pytest.FixtureRequest) -> Lab:
    """The lab in each theme."""
    lab.page.evaluate(
        "theme => window.jupyterapp.commands.execute('apputils:change-theme', {theme}).then(() => 1)", request.param
    )
    is_light = str(request.param == THEMES[0]).lower()
    lab.page.wait_for_selector(f"body[data-jp-theme-light={is_light}]", state="attached")
    return lab


@pytest.fixture(scope="module", params=(420, 1280))
def wide(lab: Lab, request: pytest.FixtureRequest) -> Iterator[Lab]:
    """The lab in a window of a laptop, and in one as narrow as a phone, where its sidebar is closed."""
    if request.param < 1000:
        lab.page.evaluate("() => window.jupyterapp.shell.collapseLeft()")
    lab.page.set_viewport_size({"width": request.param, "height": 900})
    lab.page.wait_for_function(LAID_OUT, arg=request.param < 1000)
    yield lab
    lab.page.set_viewport_size({"width": 1280, "height": 1000})
    lab.page.evaluate("() => window.jupyterapp.shell.expandLeft()")


def of_output(lab: Lab, name: str, code: str) -> Any:
    """What JavaScript says of the `outputs` of a cell, which is scrolled to."""
    lab.page.evaluate(f"id => ({CELL})(id).node.scrollIntoView()", name)
    return lab.page.evaluate(
        f"id => {{ const outputs = [...({CELL})(id).node.querySelectorAll('.jp-OutputArea-output')]; {code} }}", name
    )


def alternatives(lab: Lab, name: str) -> list[str]:
    """The alternative text of each picture in the outputs of a cell."""
    return list(
        of_output(lab, name, "return outputs.flatMap(one => [...one.querySelectorAll('img')].map(i => i.alt));")
    )


def contrasts(lab: Lab, name: str) -> list[tuple[str, float]]:
    """Words in the outputs of a cell, each with its contrast."""
    return [(word, ratio) for word, ratio in of_output(lab, name, f"return ({CONTRASTS})(outputs);")]


def test_axe_finds_nothing_that_keeps_anybody_out(themed: Lab) -> None:
    found = themed.page.evaluate(
        "() => axe.run({include: [['.jp-Cell-outputArea .jp-OutputArea-output']]}).then(found => found.violations"
        ".map(one => [one.id, one.help, one.nodes.map(node => node.html.slice(0, 200))]))"
    )
    assert found == []


@pytest.mark.parametrize("name", ALTERNATIVE)
def test_each_picture_has_its_alternative_text(lab: Lab, name: str) -> None:
    (text,) = alternatives(lab, name)
    assert text.startswith(ALTERNATIVE[name])


@pytest.mark.parametrize("name", WORDS)
def test_every_word_has_contrast(themed: Lab, name: str) -> None:
    ratios = contrasts(themed, name)
    assert len(ratios) >= WORDS[name]
    assert [word for word in ratios if word[1] < AA] == []


@pytest.mark.parametrize("name", [name for name in CELLS if name != "start"])
def test_nothing_is_cut_and_nothing_scrolls_sideways(wide: Lab, name: str) -> None:
    found = of_output(
        wide,
        name,
        "const parts = outputs.flatMap(one => [one, ...one.querySelectorAll(':not(thead, thead *, style)')]);"
        "const edge = outputs[0].closest('.jp-Cell').getBoundingClientRect().right;"
        "return parts.filter(one => one.clientWidth > 1 && (one.scrollWidth > one.clientWidth + 1"
        " || one.getBoundingClientRect().right > edge + 1)).map(one => `${one.tagName}.${one.className}`);",
    )
    assert found == []


def controls(lab: Lab, name: str) -> list[str]:
    """What can have the focus in the outputs of a cell, marked with its number."""
    return list(
        of_output(
            lab,
            name,
            "const kinds = 'button, input, select, textarea, summary, [tabindex]';"
            "return outputs.flatMap(one => [...one.querySelectorAll(kinds)])"
            ".filter(one => one.checkVisibility() && one.tabIndex >= 0 && !one.disabled)"
            ".map((one, number) => { one.dataset.control = `${number}`; return one.dataset.control; });",
        )
    )


def focused(lab: Lab) -> str | None:
    """The control that has the focus; None if that is elsewhere."""
    return lab.page.evaluate("() => document.activeElement?.dataset?.control ?? null")  # type: ignore[no-any-return]


@pytest.mark.parametrize(("name", "least"), [("log-console", 5), ("turtle", 5), ("robot", 3), ("form", 8), ("verb", 1)])
def test_tab_reaches_every_control_and_leaves_them_again(lab: Lab, name: str, least: int) -> None:
    there = controls(lab, name)
    assert len(there) >= least
    try:
        for key, order in (("Tab", there), ("Shift+Tab", there[::-1])):
            lab.page.locator(f"[data-control='{order[0]}']").focus()
            reached = [focused(lab)]
            for _ in order:
                lab.page.keyboard.press(key)
                reached.append(focused(lab))
            assert reached == [*order, None]  # all of them, and then out: no trap
    finally:
        lab.page.evaluate(
            "() => document.querySelectorAll('[data-control]').forEach(one => delete one.dataset.control)"
        )
