"""The plots: what they show of real recordings, what they say when there is nothing to show, once in a notebook."""

from __future__ import annotations

import io
import math
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import StepPatch
from nav_msgs.msg import Odometry
from PIL import Image
from rclpy.node import Node
from std_msgs.msg import String
from turtlesim.msg import Pose

from course_kit.base.figures import AMBER, COLOURS, FAINT, INK, PANEL, PAPER, SKY, as_ink, contrast
from course_kit.lab.recordings import tracks
from course_kit.lab.recordings.buffers import MessageBuffer
from course_kit.lab.recordings.plots import plot_pose, plot_rates
from course_kit.lab.recordings.rates import measure_rates
from course_kit.lab.recordings.recording import Recording, record
from course_kit.lab.recordings.topic_recording import TopicRecording
from course_kit.ros.spinning import context
from tests.kernel import Kernel
from tests.senders import Sender
from tests.waiting import wait_until


@pytest.fixture
def robot() -> Iterator[Node]:
    context.start()
    node = Node("robot")
    yield node
    node.destroy_node()


def drive(robot: Node, topic: str, make: Callable[[float], Any], seconds: float = 0.6) -> Recording:
    """Record what `make(seconds since the start)` gives at 100 Hz."""
    publisher = robot.create_publisher(type(make(0.0)), topic, 100)
    with record(topic) as recording:
        start = time.monotonic()
        sent = 0
        while (now := time.monotonic() - start) < seconds:
            publisher.publish(make(now))
            sent += 1
            time.sleep(0.01)
        wait_until(lambda: len(recording) == sent)
    return recording


def circle(now: float) -> Pose:
    """A circle of 2 m radius around (5, 5), to the left, at 2 rad/s."""
    turn = 2.0 * now
    return Pose(
        x=5 + 2 * math.cos(turn),
        y=5 + 2 * math.sin(turn),
        theta=math.remainder(turn + math.pi / 2, math.tau),
        linear_velocity=4.0,
        angular_velocity=2.0,
    )


def odometry(now: float) -> Odometry:
    pose, message = circle(now), Odometry()
    message.header.stamp.nanosec = int(now * 1e9)
    message.pose.pose.position.x, message.pose.pose.position.y = pose.x, pose.y
    message.pose.pose.orientation.z = math.sin(pose.theta / 2)
    message.pose.pose.orientation.w = math.cos(pose.theta / 2)
    message.twist.twist.linear.x, message.twist.twist.angular.z = 4.0, 2.0
    return message


def pose_stamped(now: float) -> PoseStamped:
    full = odometry(now)
    return PoseStamped(header=full.header, pose=full.pose.pose)


def axes_of(figure: Figure, ylabel: str) -> Axes:
    return next(axes for axes in figure.axes if ylabel in axes.get_ylabel())


def data(axes: Axes, line: int = 0) -> Any:
    return np.asarray(axes.get_lines()[line].get_xydata())


@pytest.mark.parametrize("make", [circle, odometry, pose_stamped])
def test_path_heading_and_velocities_of_a_circle(robot: Node, make: Callable[[float], Any]) -> None:
    recording = drive(robot, "/robot", make)
    figure = plot_pose(recording)
    path = data(axes_of(figure, "y [m]"))
    assert np.hypot(path[:, 0] - 5, path[:, 1] - 5) == pytest.approx(2.0, abs=1e-5)
    heading = data(axes_of(figure, "heading [rad]"))
    assert heading[0, 1] == pytest.approx(math.pi / 2, abs=0.2) and np.nanmax(np.abs(heading[:, 1])) <= math.pi
    linear, angular = data(axes_of(figure, "[m/s]")), data(axes_of(figure, "[rad/s]"))
    assert np.median(linear[:, 1]) == pytest.approx(4.0, rel=0.02)
    assert np.median(angular[:, 1]) == pytest.approx(2.0, rel=0.02)
    assert linear[:, 0] == pytest.approx(recording.times)
    assert "[s]" in axes_of(figure, "[rad/s]").get_xlabel() and axes_of(figure, "y [m]").get_xlabel() == "x [m]"


def test_a_turtle_is_drawn_on_its_field_with_start_end_and_equal_scales(robot: Node) -> None:
    figure = plot_pose(drive(robot, "/turtle1/pose", circle)["/turtle1/pose"], title="A circle")
    field = axes_of(figure, "y [m]")
    assert field.get_aspect() == 1.0
    assert field.patches[0].get_bbox().size == pytest.approx((11.0888889, 11.0888889))  # type: ignore[attr-defined]
    labels = [text.get_text() for text in field.get_legend().get_texts()]  # type: ignore[union-attr]
    assert labels == ["path", "start", "end"]
    assert figure.get_suptitle() == "A circle"


def test_goals_are_marked_on_the_field_beside_the_path(robot: Node) -> None:
    recording = drive(robot, "/turtle1/pose", circle)
    field = axes_of(plot_pose(recording, goals=[(7.0, 5.0), (5, 7)]), "y [m]")
    lines = {line.get_label(): line for line in field.get_lines()}
    assert np.asarray(lines["goal"].get_xydata()).tolist() == [[7.0, 5.0], [5.0, 7.0]]
    assert lines["goal"].get_linestyle() == "None" and lines["goal"].get_marker() == "+"
    assert axes_of(plot_pose(recording), "y [m]").get_legend().get_texts()[-1].get_text() == "end"  # type: ignore[union-attr]


def test_each_robot_has_its_colour_and_its_name(robot: Node) -> None:
    publishers = [robot.create_publisher(Pose, f"/turtle{n}/pose", 10) for n in (1, 2)]
    with record("/turtle1/pose", "/turtle2/pose") as recording:
        for publisher in publishers:
            publisher.publish(circle(0.0))
            publisher.publish(circle(0.1))
        wait_until(lambda: len(recording) == 4)
    field = axes_of(plot_pose(recording), "y [m]")
    labels = [text.get_text() for text in field.get_legend().get_texts()]  # type: ignore[union-attr]
    assert labels == ["/turtle1/pose", "/turtle2/pose", "start", "end"]
    lines = {line.get_label(): line.get_color() for line in field.get_lines()}
    assert lines["/turtle1/pose"] != lines["/turtle2/pose"]


def test_a_teleported_turtle_leaves_no_line_across_the_field() -> None:
    there = [Pose(x=0.02 * n, y=1.0, linear_velocity=1.25) for n in range(10)]
    here = [Pose(x=9.0 + 0.02 * n, y=9.0, linear_velocity=1.25) for n in range(10)]
    driven = tracks.track(there + here, "turtlesim/msg/Pose", np.array([0.016 * n for n in range(20)]))
    assert np.flatnonzero(driven.jumps).tolist() == [9]


def test_rate_and_periods_are_drawn_for_each_topic() -> None:
    with (
        Sender("/fast", "string", rate=500, count=100_000) as fast,
        Sender("/slow", "string", rate=50, count=100_000) as slow,
    ):
        fast.go()
        slow.go()
        with measure_rates("/fast", "/slow") as meter:
            recording = record("/fast", seconds=1.0)
    figure = plot_rates(recording, meter)
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["/fast (1)", "", "/fast (2)", "", "/slow", ""]
    medians = []
    for axes in figure.axes[1::2]:
        texts = [text.get_text() for text in axes.get_legend().get_texts()]  # type: ignore[union-attr]
        assert texts[0].startswith("median ") and texts[1].startswith("p99 ")
        medians.append(float(texts[0].split()[1]))
    # What was measured, not what was sent: a busy machine delays messages, and then brings several at once.
    came = [recording.receive_ns, *(meter.arrivals(topic)[0] for topic in ("/fast", "/slow"))]
    assert medians == pytest.approx([np.median(np.diff(np.sort(each))) * 1e-6 for each in came], rel=0.01)
    bottom_left, bottom_right = figure.axes[-2:]
    assert bottom_left.get_ylabel() == "rate [Hz]" and "[s]" in bottom_left.get_xlabel()
    assert "[ms]" in bottom_right.get_xlabel()


def test_messages_that_were_taken_out_of_order_are_drawn_in_the_order_in_which_they_came() -> None:
    buffer = MessageBuffer(["/two"])
    append = buffer.appender("/two")
    for pair in range(50):  # of two publishers, each period 10 ms
        append(b"later", pair * 20_000_000 + 10_000_000)
        append(b"sooner", pair * 20_000_000)
    left, right = plot_rates(TopicRecording("/two", String, buffer.snapshot("/two"), 0)).axes
    (rate,) = (patch for patch in left.patches if isinstance(patch, StepPatch))
    assert rate.get_data()[0] == pytest.approx([100.0] * 9)
    median = right.get_legend().get_texts()[0].get_text()  # type: ignore[union-attr]
    assert median == "median 10 ms"


@pytest.mark.parametrize("plot", [plot_pose, plot_rates])
def test_an_empty_recording_is_answered_in_one_line(plot: Callable[[Any], Figure]) -> None:
    with record("/turtle1/pose", Pose) as recording:
        pass
    for nothing in (recording, recording["/turtle1/pose"]):
        with pytest.raises(ValueError, match="the recording of /turtle1/pose is empty: no message came") as error:
            plot(nothing)
        assert "\n" not in str(error.value)


def test_what_cannot_be_drawn_is_refused() -> None:
    with record("/chatter", String) as recording:
        pass
    with pytest.raises(ValueError, match="no pose to plot: /chatter is std_msgs/msg/String"):
        plot_pose(recording)
    with pytest.raises(TypeError, match=r"plot_pose\(\) draws what record\(\) returns, not list"):
        plot_pose([1, 2, 3])  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"plot_rates\(\) draws what record\(\) and measure_rates\(\) return, not str"):
        plot_rates("/chatter")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="nothing was given to plot"):
        plot_rates()


def test_one_message_and_a_robot_that_stands_still_can_be_drawn(robot: Node) -> None:
    for seconds in (0.0001, 0.1):
        recording = drive(robot, "/still", lambda _: Pose(x=1.0, y=1.0), seconds)
        assert plot_pose(recording)._repr_png_()[0].startswith(b"\x89PNG")


def test_the_ground_is_opaque_and_what_stands_on_it_has_contrast(robot: Node) -> None:
    picture = Image.open(io.BytesIO(plot_pose(drive(robot, "/turtle1/pose", circle, 0.1))._repr_png_()[0]))
    assert picture.getchannel("A").getextrema() == (255, 255)
    for ground in (PAPER, PANEL):
        assert contrast(INK, ground) > 7 and contrast(FAINT, ground) > 4.5
        assert all(contrast(colour, ground) > 3.0 for colour in COLOURS)
        assert all(contrast(as_ink(colour), ground) > 4.5 for colour in COLOURS)
    assert contrast("#000000", "#ffffff") == pytest.approx(21.0)
    assert contrast("#777777", "#ffffff") == pytest.approx(4.48, abs=0.005)  # as others compute it
    assert all(contrast(INK, fill) > 4.5 for fill in (AMBER, SKY))


CELL = """
recording = record("/chatter", String)
talker = Node("talker").create_publisher(String, "/chatter", 10)
for _ in range(20):
    talker.publish(String(data="x"))
assert wait_until(lambda: len(recording) == 20, 10)
"""


def pictures(kernel: Kernel, cell: str) -> list[str]:
    shown = [m["content"] for m in kernel.of(cell) if m["msg_type"] in ("display_data", "execute_result")]
    return [kind for content in shown for kind in content["data"] if kind.startswith("image/")]


def test_a_cell_that_ends_in_a_plot_shows_it_once_and_one_that_does_not_shows_nothing() -> None:
    kernel = Kernel()
    try:
        kernel.run(
            "from rclpy.node import Node\nfrom std_msgs.msg import String\nfrom course_kit import plot_rates, record\n"
            "from course_kit.base.polling import wait_until"
        )
        assert pictures(kernel, kernel.run(CELL + "plot_rates(recording)")) == ["image/png"]
        assert pictures(kernel, kernel.run("figure = plot_rates(recording)")) == []
        kernel.run("import matplotlib.pyplot as plt")  # sets up the inline backend, which shows figures too
        assert pictures(kernel, kernel.run("plot_rates(recording)")) == ["image/png"]
        assert pictures(kernel, kernel.run("figure = plot_rates(recording)")) == []
        assert pictures(kernel, kernel.run("plt.plot([1, 2]); plot_rates(recording)")) == ["image/png"] * 2
    finally:
        kernel.close()
