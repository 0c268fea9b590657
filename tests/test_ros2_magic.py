"""`%ros2` in a real kernel: on the running context, interruptible, completed by Tab, silent about YAML's braces."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.domains import own_domain
from tests.kernel import Kernel

NODES = """
import time

from course_kit import run
from rclpy.node import Node
from std_msgs.msg import String

class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        self.publisher = self.create_publisher(String, "chatter", 10)
        self.create_timer(0.02, self.talk)
        self.times = []

    def talk(self):
        self.publisher.publish(String(data="hello"))
        self.times.append(time.monotonic())

talker = run(Talker)
"""

# On a busy machine the talker's timer is slower than its 50 Hz, now more and now less: its times are kept.
RATE = """
before = len(talker.times)
%ros2 topic hz /chatter --duration 2.5
print(*talker.times[before:])
"""

# Every start of a process is noted.
NOTE_STARTS = """
import sys

started = []
STARTS = "subprocess.Popen", "os.fork", "os.forkpty", "os.posix_spawn", "os.system"
sys.addaudithook(lambda event, _: started.append(event) if event in STARTS else None)
"""


@pytest.fixture(scope="module")
def kernel() -> Iterator[Kernel]:
    with own_domain():
        kernel = Kernel()
        try:
            kernel.run(NODES)
            yield kernel
        finally:
            kernel.close()


def test_a_list_names_the_nodes_of_the_notebook(kernel):
    assert kernel.text(kernel.run("%ros2 node list")) == "/talker\n"
    assert "/chatter [std_msgs/msg/String]\n" in kernel.text(kernel.run("%ros2 topic list -t"))


def test_the_command_runs_in_the_kernel_and_a_shell_line_as_a_process(kernel):
    kernel.run(NOTE_STARTS)
    kernel.run("%ros2 topic info /chatter")
    assert kernel.text(kernel.run("print(started)")) == "[]\n"
    assert kernel.text(kernel.run("!ros2 node list")).split() == ["/talker"]
    assert kernel.text(kernel.run("print(started)")) != "[]\n"


def test_a_verb_that_goes_on_ends_after_its_duration(kernel):
    *readings, times = kernel.text(kernel.run(RATE, timeout=20)).splitlines()
    assert readings[0].startswith("average rate: ")
    rate, window = float(readings[-2].split()[-1]), int(readings[-1].split()[-1])
    published = [float(time) for time in times.split()]
    # Which of the messages were the window's, nobody says: each stretch of as many is looked at.
    rates = [(window - 1) / (last - first) for first, last in zip(published, published[window - 1 :], strict=False)]
    assert min(rates) / 1.2 < rate < max(rates) * 1.2, (rate, window, rates)


def test_an_interrupt_ends_the_verb_and_leaves_the_context_alive(kernel):
    cell = kernel.send("%ros2 topic bw /chatter")
    kernel.until(lambda: "/s from" in kernel.text(cell), 15)
    kernel.manager.interrupt_kernel()
    kernel.finish(cell)
    assert not [m for m in kernel.of(cell) if m["msg_type"] == "error"]
    assert kernel.text(kernel.run("%ros2 node list")) == "/talker\n"


def test_a_failed_verb_prints_one_line_and_a_suggestion(kernel):
    text = kernel.text(kernel.run("%ros2 topic info /chater"))
    assert text == "Unknown topic '/chater'\nDid you mean /chatter?\n"


def test_a_wrong_command_line_prints_the_usage(kernel):
    text = kernel.text(kernel.run("%ros2 topic info"))
    assert text.startswith("usage: ros2 topic info ")
    assert "the following arguments are required: topic_name" in text


def test_the_braces_of_yaml_are_not_taken_for_variables(kernel):
    kernel.run("x = y = data = 'a variable of the notebook'")
    text = kernel.text(kernel.run('%ros2 topic pub --times 1 -w 0 /talk std_msgs/msg/String "{data: y}"'))
    assert "publishing #1: std_msgs.msg.String(data='y')" in text


def test_an_open_quote_is_said_in_one_line(kernel):
    text = kernel.text(kernel.run('%ros2 topic pub /talk std_msgs/msg/String "{data: x}'))
    assert text.startswith("ros2: No closing quotation")
    assert len(text.splitlines()) == 1


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("%ros2 top", "topic"),
        ("%ros2 topic ec", "echo"),
        ("%ros2 topic echo /cha", "/chatter"),
        ("%ros2 topic pub /new geometry_msgs/msg/Twis", "geometry_msgs/msg/Twist"),
        ("%ros2 node info /ta", "/talker"),
        ("%ros2 param get /talker use", "use_sim_time"),
        ("%ros2 service call /talker/list", "/talker/list_parameters"),
        ("%ros2 topic pub /new geometry_msgs/msg/Twist '{li", "'{linear:"),
        ('%ros2 topic pub /new geometry_msgs/msg/Twist "{linear: {x: 1.0, ', "y:"),
        ("%ros2 topic pub /new std_msgs/msg/Bool ", "'{data: false}'"),
    ],
)
def test_tab_completes_commands_names_and_types(kernel, line, expected):
    answer = kernel.client.complete(line, len(line), reply=True, timeout=20)["content"]
    begun = line[answer["cursor_start"] :]
    assert expected in {begun_word(line, answer["cursor_start"]) + m.strip() for m in answer["matches"]}, (
        begun,
        answer,
    )


def begun_word(line: str, start: int) -> str:
    """What of the last word stands before the part that a match replaces."""
    return line[:start].rsplit(" ", 1)[-1]
