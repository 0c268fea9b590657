"""A form in a real kernel: what it leaves in the notebook, how it ends, that nothing of it stays."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from tests.kernel import Kernel, kernel_after

SET_UP = """
import ctypes, gc, threading, psutil
from ipywidgets.widgets.widget import _instances
from course_kit import run, show_form, wait_for
from course_kit import TurtleSim
from course_kit.ros.subscriptions import observer_node
turtlesim = run(TurtleSim)

def press(form, button, **entries):
    # As the page does it: all that is typed in, and the button.
    typed = form.entries
    for name, text in entries.items():
        typed[name] = text
    form.widget._handle_custom_msg({"do": button, "entries": typed, "rate": "10", "by": "a page"}, [])

def left():
    gc.collect()
    ctypes.CDLL(None).malloc_trim(0)  # what was freed goes back to the system, which counts it otherwise
    node = observer_node.node()
    return len(_instances), threading.active_count(), len(list(node.publishers)), len(list(node.timers))
"""

OPEN_AND_CLOSE = """
def open_and_close(times):
    for number in range(times):
        form = show_form(('/turtle1/cmd_vel', '/spawn')[number % 2])
        press(form, 'read')
        form.stop()
"""


@pytest.fixture(scope="module")
def kernel() -> Iterator[Kernel]:
    with kernel_after(SET_UP) as one:
        yield one


def bundles(kernel: Kernel, cell: str) -> list[dict[str, Any]]:
    """What a cell has shown: first, then each update."""
    (first,) = [m["content"] for m in kernel.of(cell) if m["msg_type"] == "display_data"]
    identity = first["transient"]["display_id"]
    updates = [m["content"] for m in kernel.messages if m["msg_type"] == "update_display_data"]
    return [first["data"], *(one["data"] for one in updates if one["transient"]["display_id"] == identity)]


def test_a_still_of_command_state_and_answer_stays_in_the_notebook(kernel: Kernel) -> None:
    cell = kernel.run("form = show_form('/spawn')")
    first = bundles(kernel, cell)[0]
    assert first["text/plain"] == "ros2 service call /spawn turtlesim/srv/Spawn"
    assert first["application/vnd.course-kit.view+json"] == {"view": "form"}
    assert "application/vnd.jupyter.widget-view+json" in first and "ros2 service call" in first["text/html"]
    kernel.run("press(form, 'send', x='2', name='raphael')\nwait_for(lambda: form._sender.state.answer, 20)")
    kernel.until(lambda: "name: raphael" in kernel.shown(cell), 20)
    kernel.run("form.stop()")
    last = bundles(kernel, cell)[-1]
    command, said, answer = last["text/plain"].splitlines()
    assert command == "ros2 service call /spawn turtlesim/srv/Spawn '{x: 2.0, name: raphael}'"
    assert said.startswith("answered after ") and answer == "name: raphael"
    assert "application/vnd.jupyter.widget-view+json" not in last
    assert kernel.value("form, form.widget.comm") == "<form, stopped> None"


def test_what_does_not_fit_is_not_sent(kernel: Kernel) -> None:
    cell = kernel.run("form = show_form('/turtle1/teleport_absolute')\npress(form, 'send', x='here')")
    assert kernel.value("form.widget.problems") == ("{'x': \"x takes a float32, a number such as 0.5, not 'here'.\"}")
    assert kernel.value("form._sender.state.is_busy, form.widget.program") == (
        "False # x takes a float32, a number such as 0.5, not 'here'."
    )
    kernel.run("press(form, 'read', x='1')")
    assert kernel.value("form.widget.problems, form._sender.state.line") == "{}"
    assert "Form" not in kernel.text(cell)
    kernel.run("form.stop()")


def test_what_fails_is_said_in_the_form(kernel: Kernel) -> None:
    kernel.run("form = show_form('/turtle1/cmd_vel')\nform._sender._publisher.destroy()\npress(form, 'send')")
    assert "InvalidHandle" in kernel.value("form.widget.state['line']")
    assert kernel.value("form.widget.state['is_problem']") == "True"
    kernel.run("form.stop()")


def test_the_next_run_of_its_cell_ends_it_and_what_it_publishes(kernel: Kernel) -> None:
    kernel.run("first = show_form('/turtle1/cmd_vel')\npress(first, 'start')")
    assert "--rate 10" in kernel.value("first.widget.command")
    kernel.run("second = show_form('/turtle1/cmd_vel')")
    assert kernel.value("first.is_running, second.is_running, first._sender.state.is_busy") == "False True False"
    kernel.run("both = show_form('/spawn'), show_form('/kill')")
    assert kernel.value("[one.is_running for one in both]") == "[True, True]"
    kernel.run("for one in both: one.stop()")


def test_a_form_ends_with_ros(kernel: Kernel) -> None:
    kernel.run("form = show_form('/turtle1/cmd_vel')\npress(form, 'start')\nimport rclpy\nrclpy.shutdown()")
    kernel.run("from course_kit.ros.spinning import context\ncontext.stop()")
    assert kernel.value("form.is_running") == "False"
    kernel.run("turtlesim = run(TurtleSim)")


def test_200_forms_leave_nothing(kernel: Kernel) -> None:
    kernel.run(OPEN_AND_CLOSE)
    kernel.run("open_and_close(40)", 120)
    kernel.run("before, memory = left(), psutil.Process().memory_info().rss")
    kernel.run("open_and_close(200)", 300)
    kernel.until(
        lambda: kernel.value("all(now <= then for now, then in zip(left(), before)) or (left(), before)") == "True", 20
    )
    assert float(kernel.value("psutil.Process().memory_info().rss / memory")) < 1.05
