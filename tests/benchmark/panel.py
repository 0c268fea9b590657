"""The turtle panel in a browser: how often it moves there, what of a core its kernel takes; matplotlib beside it."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple
from unittest import mock

import nbformat
import psutil  # type: ignore[import-untyped]
from nbformat.v4 import new_code_cell, new_notebook

from tests.benchmark.table import Row, at_least, at_most
from tests.lab import CHROMIUM, Lab, browser, server

IPYMPL = "ipympl==0.10.0"
NOTE = (
    "panel: a simulator and what shows it in one kernel, JupyterLab in headless chromium here; turtles drive circles. "
    "Sent: messages with moves from the kernel; shown: how often the picture was another at a frame of the browser's; "
    "kernel: of one core, simulator included. plain: the same poses by rclpy, drawn by matplotlib as a picture that is "
    f"shown anew, and by a FuncAnimation in {IPYMPL}, installed for the run (empty if it cannot be)."
)
START = """
import os, psutil, threading, time
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose
from course_kit import run
from course_kit import TurtleSim
from course_kit.ros.subscriptions import clients
from turtlesim.srv import Spawn
class Circles(Node):
    def __init__(self):
        super().__init__("circles")
        self.of = [self.create_publisher(Twist, f"/turtle{n}/cmd_vel", 7) for n in range(1, 11)]
        self.create_timer(0.5, self.drive)
    def drive(self):
        twist = Twist()
        twist.linear.x, twist.angular.z = 1.0, 1.0
        for one in self.of:
            one.publish(twist)
class Listener(Node):
    def __init__(self):
        super().__init__("listener")
        self.x, self.y = [], []
        self.create_subscription(Pose, "/turtle1/pose", self.note, 10)
    def note(self, pose):
        self.x.append(pose.x)
        self.y.append(pose.y)
turtlesim, circles = run(TurtleSim), run(Circles)
os.getpid()
"""
FIGURE = """
import matplotlib.pyplot as plt
listener = run(Listener)
figure, axes = plt.subplots(figsize=(4, 4))
axes.set(xlim=(0, 11), ylim=(0, 11))
(line,) = axes.plot([], [])
"""
PICTURES = """
plt.close(figure)  # else it is shown at the end of the cell, too
shown = display(figure, display_id=True)
def animate():
    while True:
        line.set_data(listener.x, listener.y)
        shown.update(figure)
threading.Thread(target=animate, daemon=True).start()
"""
WIDGET = """
from matplotlib.animation import FuncAnimation
def step(_):
    line.set_data(listener.x, listener.y)
    return (line,)
animation = FuncAnimation(figure, step, interval=16, blit=True, cache_frame_data=False)
plt.show()
"""
TEN = """
for number in range(9):
    clients.call(Spawn, "/spawn", Spawn.Request(x=2.0 + 0.7 * number, y=4.0, theta=0.0), 5, 5)
"""
NOTEBOOKS = {
    "panel": {"start": START, "show": "from course_kit import drive\npanel = drive()", "ten": TEN},
    "pictures": {"start": START, "show": FIGURE + PICTURES},
    "ipympl": {"start": START, "show": "%matplotlib widget\n" + FIGURE + WIDGET},
}
SHOWN = {
    "panel": ".course-kit-turtle-field canvas",
    "pictures": ".jp-OutputArea-output img",
    "ipympl": ".jupyter-matplotlib-canvas-container canvas",
}
WATCH = """selector => {
  const small = document.createElement('canvas'); small.width = small.height = 64;
  const context = small.getContext('2d', {willReadFrequently: true});
  const counts = window.counts = {shown: 0, sent: 0};
  let before = 0;
  const look = () => {
    const one = document.querySelector(selector);
    if (one && (one.complete ?? true)) {
      context.clearRect(0, 0, 64, 64);
      context.drawImage(one, 0, 0, 64, 64);
      let sum = 0;
      for (const part of context.getImageData(0, 0, 64, 64).data) sum = (sum * 31 + part) | 0;
      if (sum !== before) counts.shown++;
      before = sum;
    }
    requestAnimationFrame(look);
  };
  look();
  window.jupyterapp.shell.currentWidget.sessionContext.iopubMessage.connect((_, message) => {
    if (message.content.data?.content?.kind === 'moves') counts.sent++;
  });
}"""


class Measured(NamedTuple):
    """Numbers a second, and the kernel's share of a core in percent."""

    sent: float
    shown: float
    kernel: float


def rows(quick: bool) -> Iterator[Row]:
    """All rows of this section."""
    if CHROMIUM is None:
        return
    seconds = 5.0 if quick else 20.0
    with ExitStack() as stack:
        extra = Path(stack.enter_context(tempfile.TemporaryDirectory(ignore_cleanup_errors=True)))
        environ = {"PYTHONPATH": str(extra), "JUPYTER_PATH": str(extra / "share" / "jupyter")}
        names = ["pictures", *(["ipympl"] if _install(extra) else []), "panel"]
        stack.enter_context(mock.patch.dict(os.environ, environ))
        folders = [Path(stack.enter_context(tempfile.TemporaryDirectory())) for _ in range(3)]
        for name in names:
            notebook = new_notebook(
                cells=[new_code_cell(code.strip(), id=id_) for id_, code in NOTEBOOKS[name].items()]
            )
            notebook.metadata["kernelspec"] = {"name": "python3", "display_name": "Python 3", "language": "python"}
            nbformat.write(notebook, folders[0] / f"{name}.ipynb")
        address = stack.enter_context(server(folders[0], folders[1]))
        lab = stack.enter_context(browser(address, folders[2]))
        found: dict[str, Measured] = {}
        for name in names:
            found |= _measure(lab, name, seconds)
    yield from _table(found)


def _table(found: Mapping[str, Measured]) -> Iterator[Row]:
    panel, ten = found["panel"], found["ten"]
    yield at_least("turtle panel, one turtle: sent", "1/s", panel.sent, 60.0)
    for name, plain in (("pictures of matplotlib", found["pictures"]), ("ipympl", found.get("ipympl"))):
        yield at_least(f"turtle panel, one turtle: shown; {name}", "1/s", panel.shown, 30.0, plain and plain.shown)
        yield at_most(
            f"turtle panel, one turtle: kernel; {name}", "% of a core", panel.kernel, 25.0, plain and plain.kernel
        )
    yield at_least("turtle panel, ten turtles: sent", "1/s", ten.sent, 60.0)
    yield at_least("turtle panel, ten turtles: shown", "1/s", ten.shown, 30.0)
    yield at_most("turtle panel, ten turtles: kernel", "% of a core", ten.kernel, 50.0)


def _install(folder: Path) -> bool:
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", str(folder), IPYMPL]
    return subprocess.run(command, capture_output=True, timeout=120).returncode == 0


def _measure(lab: Lab, name: str, seconds: float) -> dict[str, Measured]:
    """What a notebook shows, and the panel with ten turtles as well."""
    lab.open(f"{name}.ipynb")
    for cell in NOTEBOOKS[name]:
        if cell != "ten":
            lab.run_cell(cell)
    assert not lab.errors(), lab.errors()
    process = psutil.Process(int(lab.outputs("start")[-1]["data"]["text/plain"]))
    lab.page.wait_for_selector(SHOWN[name], timeout=30_000)
    lab.page.evaluate(WATCH, SHOWN[name])
    found = {name: _watched(lab, process, seconds)}
    if "ten" in NOTEBOOKS[name]:
        lab.run_cell("ten")
        found["ten"] = _watched(lab, process, seconds)
    lab.close_notebook()
    return found


def _watched(lab: Lab, process: psutil.Process, seconds: float) -> Measured:
    lab.page.wait_for_timeout(2000)  # what begins is over
    process.cpu_percent()
    before = lab.page.evaluate("() => ({...window.counts, at: performance.now()})")
    lab.page.wait_for_timeout(1000 * seconds)
    share = process.cpu_percent()
    after = lab.page.evaluate("() => ({...window.counts, at: performance.now()})")
    passed = (after["at"] - before["at"]) / 1000
    sent, shown = ((after[one] - before[one]) / passed for one in ("sent", "shown"))
    return Measured(sent, shown, share)
