"""The callbacks of a node and when they ran: read from nodes and programs, and drawn."""

from __future__ import annotations

import sys

import pytest
from example_interfaces.srv import AddTwoInts
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String

from course_kit import run, start, stop, wait_for
from course_kit.lab.callbacks.callback_groups import Callback, Execution, Group
from course_kit.lab.callbacks.callback_time_plots import plot_callback_times
from course_kit.lab.callbacks.callback_times import Span, run_of
from course_kit.lab.callbacks.executor_plots import plot_executor
from course_kit.lab.callbacks.node_callbacks import execution_of

TOLD = ["hello", "threads 2", "callback take Pool-1 10.5 10.5001", "callback test Pool-0 10.0 10.5"]


class Asking(Node):
    """Has a callback of each kind; the client in the group given."""

    def __init__(self, group=None):
        super().__init__("asking")
        self.create_client(AddTwoInts, "add", callback_group=group)
        self.create_timer(0.2, self.tick)
        self.create_subscription(String, "words", lambda message: None, 10)
        self.create_service(AddTwoInts, "serve", self.serve)

    def tick(self):
        pass

    async def serve(self, request, response):
        return response


@pytest.fixture(autouse=True)
def stopped():
    yield
    stop()


def test_everything_is_in_the_default_group_unless_another_is_named():
    read = execution_of(run(Asking))
    (group,) = read.groups
    assert (read.node, read.threads) == ("/asking", 1)
    assert set(group.callbacks) == {
        Callback("timer", "every 0.2 s", "tick"),
        Callback("subscription", "message on /words", "lambda"),
        Callback("service", "request of /serve", "async serve"),
        Callback("client", "response of /add", "complete the future"),
    }
    assert group.is_default and not group.is_reentrant and group.others >= 6
    assert read.at_once == "One thread: one callback at a time, whatever their groups."


@pytest.mark.parametrize(
    ("group", "threads", "says"),
    [
        (None, 2, "2 threads, but one mutually exclusive group: one callback at a time."),
        (MutuallyExclusiveCallbackGroup, 3, "3 threads and 2 groups: up to 2 callbacks at a time, one of each group."),
        (ReentrantCallbackGroup, 3, "3 threads and a reentrant group: up to 3 callbacks at a time."),
    ],
)
def test_groups_and_threads_say_what_may_run_at_the_same_time(group, threads, says):
    run(Node, "first")  # an executor needs ROS
    node = run(Asking, group and group(), executor=MultiThreadedExecutor(num_threads=threads))
    read = execution_of(node)
    assert (read.executor, read.threads) == ("MultiThreadedExecutor", threads)
    assert read.at_once == says
    plot = plot_executor(node)
    texts = [text.get_text() for text in plot.axes[0].texts]
    assert says in texts and [f"thread {number + 1}" in texts for number in range(threads + 1)] == [True] * threads + [
        False
    ]
    assert repr(plot).endswith(says)
    assert plot._repr_png_()[0].startswith(b"\x89PNG")


def test_a_node_that_nobody_spins_runs_no_callback():
    run(Node, "first")
    node = Node("alone")
    assert execution_of(node).at_once.startswith("No executor")
    assert plot_executor(node).description.endswith("none of its callbacks runs.")
    node.destroy_node()


def test_what_is_no_node_is_refused():
    with pytest.raises(TypeError, match="draws a node"):
        plot_executor("asking")


def test_one_group_of_rclpy_alone_needs_no_second_thread():
    assert Execution("/a", "X", 2, (Group(False, True, ()),)).at_once.endswith("one callback at a time.")


def test_the_calls_of_callbacks_are_read_by_their_beginning():
    read = run_of(TOLD)
    assert read.threads == 2
    assert read.spans == (Span("test", 1, 10.0, 10.5), Span("take", 2, 10.5, 10.5001))
    with pytest.raises(ValueError, match="has printed no line"):
        run_of(["hello"])


def test_programs_are_drawn_with_their_threads_and_what_lay_in_the_queue():
    program = start([sys.executable, "-c", f"print({chr(10).join(TOLD)!r})"], name="two threads")
    wait_for(program, timeout=20)
    plot = plot_callback_times([program], [10.2])
    (axes,) = plot.axes
    assert [label.get_text() for label in axes.get_yticklabels()] == ["thread 1", "thread 2", "response in the queue"]
    assert [round(bar.get_width(), 3) for bar in axes.patches] == [0.5, 0.3]
    assert plot.description.startswith("two threads: test ran for 0.5 s, the response came after 0.2 s")
    with pytest.raises(ValueError, match="one time for each program"):
        plot_callback_times([program], [])
