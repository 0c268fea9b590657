"""The live views in a real kernel: they show, they change, they end."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.kernel import Kernel, kernel_after

SET_UP = """
from rclpy.node import Node
from geometry_msgs.msg import PoseStamped
from turtlesim.msg import Pose
from course_kit import run, stop
from course_kit import watch_rates
from course_kit import watch_resources
from course_kit import watch_values
from course_kit import watch_logs

class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.poses = self.create_publisher(Pose, "/turtle1/pose", 10)
        self.goals = self.create_publisher(PoseStamped, "/goal", 10)
        self.create_timer(0.02, self.tick)
        self.count = 0

    def tick(self):
        self.count += 1
        self.poses.publish(Pose(x=float(self.count)))
        goal = PoseStamped()
        goal.header.stamp = self.get_clock().now().to_msg()
        self.goals.publish(goal)
        self.get_logger().info(f"step {self.count}")
        if self.count % 10 == 0:
            self.get_logger().warn("ten <more>")

robot = run(Robot)
"""


@pytest.fixture(scope="module")
def kernel() -> Iterator[Kernel]:
    with kernel_after(SET_UP) as one:
        yield one


def of_view(kernel: Kernel, cell: str) -> str:
    """What a cell's view shows now; empty before it shows anything."""
    try:
        return kernel.shown(cell)
    except StopIteration:
        return ""


def updates(kernel: Kernel, cell: str) -> list[Any]:
    shown = [m["content"] for m in kernel.of(cell) if m["msg_type"] == "display_data"]
    identity = shown[0]["transient"]["display_id"]
    changed = [m["content"] for m in kernel.messages if m["msg_type"] == "update_display_data"]
    return [one["data"] for one in changed if one["transient"]["display_id"] == identity]


def test_rates_of_all_topics_are_shown_and_new_topics_join(kernel: Kernel) -> None:
    cell = kernel.run("view = watch_rates(period=0.2)\nview")

    def row(topic: str) -> list[str]:
        return next((line.split() for line in of_view(kernel, cell).splitlines() if line.startswith(topic)), [])

    # The first rates may be those of a few messages that came in a burst on a busy machine.
    kernel.until(lambda: "Hz" in row("/goal") and 0 < float(row("/goal")[2]) < 70, 20)
    assert row("/goal")[1] == "/robot" and 0 < float(row("/goal")[8]) < 1000
    assert row("/turtle1/pose")[8] == "-"  # a turtle's pose has no stamp
    kernel.until(lambda: "lines/s" in of_view(kernel, cell))
    assert row("/robot")
    kernel.run("late = run(Node, 'late'); there = late.create_publisher(Pose, '/late', 10)")
    kernel.until(lambda: row("/late"), 20)
    assert len([m for m in kernel.of(cell) if m["msg_type"] in ("display_data", "execute_result")]) == 1
    kernel.run("view.stop(); stop('late')")
    assert kernel.value("view") == "<rates, stopped>"


def test_named_topics_only(kernel: Kernel) -> None:
    cell = kernel.run("view = watch_rates('/goal', period=0.2)")
    kernel.until(lambda: "/goal" in of_view(kernel, cell) and "Hz" in of_view(kernel, cell), 20)
    assert "/turtle1/pose" not in of_view(kernel, cell)
    kernel.run("view.stop()")


def test_resources_are_shown(kernel: Kernel) -> None:
    cell = kernel.run("view = watch_resources(period=0.2)")
    kernel.until(lambda: "this notebook" in of_view(kernel, cell) and "MB" in of_view(kernel, cell), 20)
    assert "thread of /robot" in of_view(kernel, cell)
    kernel.run("view.stop()")


def test_values_are_drawn_as_they_come_until_the_end(kernel: Kernel) -> None:
    cell = kernel.run("view = watch_values('/turtle1/pose.x', '/goal.pose.position.x', period=0.2)")
    kernel.until(lambda: len({data["image/png"] for data in updates(kernel, cell)}) >= 3, 20)
    kernel.run("view.stop()")
    assert kernel.value("view.is_running") == "False"
    count = len(updates(kernel, cell))
    assert kernel.value("1") == "1" and len(updates(kernel, cell)) == count


def test_a_view_ends_by_itself_after_its_seconds(kernel: Kernel) -> None:
    kernel.run("view = watch_values('/turtle1/pose.x', period=0.2, seconds=1)")
    kernel.until(lambda: kernel.value("view.is_running") == "False", 20)


def test_the_log_console_filters_by_node_level_and_text(kernel: Kernel) -> None:
    kernel.run("panel = watch_logs()")
    kernel.until(lambda: "step" in kernel.value("panel._lines.value"), 20)
    kernel.run("panel.level.value = 'WARN'")
    assert kernel.value("{line.level_name for line in panel.shown()}") == "{'WARN'}"
    kernel.until(lambda: "ten &lt;more&gt;" in kernel.value("panel._lines.value"), 20)
    kernel.until(lambda: "step" not in kernel.value("panel._lines.value"), 20)
    kernel.run("panel.level.value = 'DEBUG'; panel.text.value = 'STEP'; panel.node.value = '/robot'")
    assert kernel.value("{line.level_name for line in panel.shown()}") == "{'INFO'}"
    assert kernel.value("'/robot' in panel.node.options") == "True"


def test_the_log_console_sets_levels(kernel: Kernel) -> None:
    kernel.run("panel = watch_logs('/robot', 'DEBUG')\npanel.set_level.value = 'ERROR'")
    assert kernel.value("robot.get_logger().get_effective_level().name") == "ERROR"
    assert "/robot logs ERROR" in kernel.value("panel._answer.value")
    kernel.run("panel.set_level.value = 'INFO'; panel.node.value = 'all nodes'; panel.set_level.value = 'DEBUG'")
    assert "choose a node first" in kernel.value("panel._answer.value")
    kernel.run("panel.close()")


def test_a_log_console_that_cannot_be_drawn_is_said_to_stand_still(kernel: Kernel) -> None:
    cell = kernel.run("panel = watch_logs()\npanel.shown = lambda: 1 / 0")
    kernel.until(lambda: "stands still: ZeroDivisionError: " in of_view(kernel, cell), 20)
    assert "Run its cell again to go on." in of_view(kernel, cell)
    kernel.until(lambda: kernel.value("panel.is_running") == "False", 20)


def test_the_log_console_keeps_a_still_of_what_it_shows_and_its_widgets_end_with_it(kernel: Kernel) -> None:
    before = kernel.value("len(get_ipython().kernel.comm_manager.comms)")
    cell = kernel.run("panel = watch_logs('/robot', 'WARN')\npanel")
    kernel.until(lambda: "[WARN] [/robot] ten <more>" in of_view(kernel, cell), 20)
    assert of_view(kernel, cell).startswith("Log lines of /robot, WARN and above:\n")
    first = next(m["content"]["data"] for m in kernel.of(cell) if m["msg_type"] == "display_data")
    assert {"application/vnd.jupyter.widget-view+json", "text/html"} <= first.keys()
    kernel.run("panel.text.value = 'MORE'\npanel.stop()")
    kernel.until(lambda: "application/vnd.jupyter.widget-view+json" not in updates(kernel, cell)[-1], 20)
    last = updates(kernel, cell)[-1]
    assert "ten &lt;more&gt;" in last["text/html"] and "ten <more>" in last["text/plain"]
    assert kernel.value("len(get_ipython().kernel.comm_manager.comms)") == before


def test_the_console_of_a_node_says_why_it_stands_still_and_goes_on(kernel: Kernel) -> None:
    cell = kernel.run(
        "class Second(Node):\n    def __init__(self):\n        super().__init__('second')\n"
        "        self.create_timer(0.05, lambda: self.get_logger().info('still here'))\nsecond = run(Second)"
    )
    kernel.until(lambda: "still here" in of_view(kernel, cell), 20)
    kernel.run("from course_kit.views.live import console\nconsole._consoles['/second'].state = 'unheard of'")
    kernel.until(lambda: "stands still: KeyError: " in of_view(kernel, cell), 20)
    kernel.run("console._consoles['/second'].state = 'running'")
    kernel.until(lambda: "still here" in of_view(kernel, cell), 20)
    kernel.run("stop(second)")


def test_the_console_of_a_stopped_node_does_not_show_what_another_node_of_its_name_says(kernel: Kernel) -> None:
    cell = kernel.run("second = run(Node, 'second')\nsecond.get_logger().info('its own')\nstop(second)")
    kernel.until(lambda: "its own" in of_view(kernel, cell) and "stopped" in of_view(kernel, cell), 20)
    kernel.run("from course_kit import logs\nfrom course_kit.views.live import console\nother = Node('second')")
    kernel.run("other.get_logger().info('a namesake')\nother.get_logger().info('and again')")
    # When the second line is there, the first has been handled.
    kernel.until(lambda: kernel.value("len(logs('second', text='and again'))") == "1", 20)
    shown = kernel.value("[line.text for line in console._consoles['/second'].lines]")
    assert shown == "['its own']"
    kernel.run("other.destroy_node()")


def test_a_cell_that_is_run_again_replaces_its_view(kernel: Kernel) -> None:
    kernel.run("first = watch_rates('/goal', period=0.2)")
    kernel.run("second = watch_rates('/goal', period=0.2)")
    assert kernel.value("first.is_running, second.is_running") == "False True"
    kernel.run("third, fourth = watch_rates('/goal'), watch_rates('/turtle1/pose')")
    assert kernel.value("second.is_running, third.is_running, fourth.is_running") == "False True True"
    kernel.run("third.stop(); fourth.stop()")


def test_a_bad_path_and_the_end_of_ros_are_survived(kernel: Kernel) -> None:
    cell = kernel.send("watch_values('/turtle1/pose.xx')")
    kernel.finish(cell)
    (error,) = [m["content"] for m in kernel.of(cell) if m["msg_type"] == "error"]
    assert error["ename"] == "ValueError" and "Did you mean '/turtle1/pose.x'?" in error["evalue"]
    kernel.run("view = watch_rates(period=0.1); panel = watch_logs(); used = watch_resources(period=0.1)")
    kernel.run("from course_kit.ros.spinning import context; context.stop()", 30)
    assert kernel.value("view.is_running, used.is_running") == "False False"


def test_a_node_runs_in_ipython_without_a_kernel_too() -> None:
    cells = "from rclpy.node import Node\nfrom course_kit import run\nrun(Node, 'plain');\n"
    ipython = Path(sys.executable).with_name("ipython")
    done = subprocess.run([ipython, "--no-banner"], input=cells, capture_output=True, text=True, timeout=60)
    assert "▶ /plain running" in done.stdout and "Error" not in done.stdout
