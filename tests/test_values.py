"""Numbers by their path: live, from a recording, from a bag; as a picture and as CSV; what a bad path is told."""

from __future__ import annotations

import csv
import math
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Odometry
from nav_msgs.msg import Path as PathMessage
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool, Float64MultiArray, String
from turtlesim.msg import Pose

from course_kit.lab import bags
from course_kit.lab.recordings.recording import record
from course_kit.lab.series.field_paths import numeric_fields, parse, reader
from course_kit.lab.series.value_plots import plot_values
from course_kit.lab.series.value_series import Values, save_csv, values
from course_kit.ros.spinning import context
from tests.waiting import wait_until

COUNT = 40


@pytest.fixture(scope="module")
def robot() -> Iterator[Node]:
    """Publishes a numbered pose and a scan on and on."""
    context.start()
    node = Node("robot")
    poses, scans = node.create_publisher(Pose, "/turtle1/pose", 100), node.create_publisher(LaserScan, "/scan", 100)
    ended = threading.Event()

    def publish_on() -> None:
        number = 0
        while not ended.wait(0.005):
            poses.publish(Pose(x=float(number % 1000), y=1.0))
            scans.publish(LaserScan(ranges=[0.5, math.inf]))
            number += 1

    thread = threading.Thread(target=publish_on)
    thread.start()
    yield node
    ended.set()
    thread.join()
    node.destroy_node()
    context.stop()


def read(message: Any, path: str) -> float:
    return reader(type(message), parse(f"/topic.{path}"))(message)


def test_numbers_at_any_depth_are_read() -> None:
    stop = PoseStamped()
    stop.pose.position.x = 2.5
    odometry = Odometry()
    odometry.pose.covariance[7] = 4.0
    assert read(PathMessage(poses=[stop]), "poses[0].pose.position.x") == 2.5
    assert read(odometry, "pose.covariance[7]") == 4.0
    assert read(LaserScan(ranges=[1.0, 2.0]), "ranges[-1]") == 2.0
    assert read(Bool(data=True), "data") == 1.0
    assert math.isnan(read(Float64MultiArray(data=[1.0]), "data[3]"))
    assert math.isnan(read(PathMessage(), "poses[0].pose.position.x"))


def test_every_number_of_a_type_is_found() -> None:
    assert list(numeric_fields(Pose)) == ["x", "y", "theta", "linear_velocity", "angular_velocity"]
    assert "pose.pose.orientation.w" in set(numeric_fields(Odometry))
    assert list(numeric_fields(String)) == []
    for field in numeric_fields(Odometry):
        assert read(Odometry(), field) in (0.0, 1.0)


@pytest.mark.parametrize(
    ("path", "told"),
    [
        ("/turtle1/pose", "needs a field after a dot. Its numbers: x, y, theta"),
        ("/turtle1/pose.xx", "has no field 'xx'. Did you mean '/turtle1/pose.x'?"),
        ("/turtle1/pose.pose.x", "Did you mean '/turtle1/pose.x'?"),
        ("/turtle1/pose/x", "/turtle1/pose/x is no topic, but /turtle1/pose is one: write '/turtle1/pose.x'"),
        ("/scan.ranges", "say which element, as in '/scan.ranges[0]'"),
        ("/scan.header", "as in '/scan.header.stamp.sec'"),
        ("/scan.header.frame_id", "is a string and not a number"),
        ("/scan.angle_min[0]", "leave the [0] out"),
        ("/scan.ranges[x]", "Did you mean '/scan.ranges[0]'"),
    ],
)
def test_a_bad_path_is_answered_in_one_line_with_a_suggestion(robot: Node, path: str, told: str) -> None:
    with pytest.raises(ValueError) as error:
        values(path)
    assert told in str(error.value) and "\n" not in str(error.value)


def test_an_index_that_no_message_has_is_refused_where_the_type_says_so() -> None:
    with pytest.raises(ValueError, match=r"elements \[0\] to \[35\], and no \[36\]"):
        read(Odometry(), "pose.covariance[36]")


def test_values_are_those_that_were_sent(robot: Node) -> None:
    there = values("/turtle1/pose.x", "/scan.ranges[0]", "/scan.ranges[7]", seconds=0.4)
    x = there["/turtle1/pose.x"]
    assert len(x) > 10 and x.times.shape == x.values.shape
    assert set(np.diff(x.values)) <= {1.0, -999.0}
    assert x.times[0] >= 0 and np.all(np.diff(x.times) >= 0) and x.times[-1] < 5
    assert set(there["/scan.ranges[0]"].values) == {0.5}
    assert np.isnan(there["/scan.ranges[7]"].values).all()
    shown = repr(there)
    assert shown.splitlines()[0].split()[:2] == ["path", "messages"] and len(shown.splitlines()) == 4
    with pytest.raises(KeyError, match=r"/turtle1/pose\.y. was not read"):
        there["/turtle1/pose.y"]


def test_a_recording_and_a_bag_give_the_same_values(robot: Node, tmp_path: Path) -> None:
    with bags.record(tmp_path / "bag", "/turtle1/pose") as bag, record("/turtle1/pose", "/scan") as recording:
        wait_until(lambda: bag.message_count >= COUNT and len(recording["/turtle1/pose"]) >= COUNT)
    live = values("/turtle1/pose.x", source=recording)["/turtle1/pose.x"]
    recorded = values("/turtle1/pose.x", source=tmp_path / "bag")["/turtle1/pose.x"]
    common, here, there = np.intersect1d(live.values, recorded.values, return_indices=True)
    assert len(common) > COUNT // 2
    assert np.abs(live.receive_ns[here] - recorded.receive_ns[there]).max() < 1e9
    assert recorded.times[0] == 0.0
    for source in (recording, tmp_path / "bag"):
        with pytest.raises(ValueError, match=r"has no topic /turtle1/pos; .* Did you mean '/turtle1/pose\.x'\?"):
            values("/turtle1/pos.x", source=source)


def test_a_csv_has_a_column_a_path_and_a_line_a_message(robot: Node, tmp_path: Path) -> None:
    there = values("/turtle1/pose.x", "/turtle1/pose.y", "/scan.ranges[0]", seconds=0.2)
    with save_csv(there, tmp_path / "out.csv").open() as file:
        head, *rows = csv.reader(file)
    assert head == ["time", "/turtle1/pose.x", "/turtle1/pose.y", "/scan.ranges[0]"]
    times = [float(row[0]) for row in rows]
    assert times == sorted(times)
    for column, path in enumerate(head[1:], 1):
        written = [(float(row[0]), float(row[column])) for row in rows if row[column]]
        assert [value for _, value in written] == there[path].values.tolist()
        assert [when for when, _ in written] == pytest.approx(there[path].times, abs=1e-8)
    assert any(not row[3] for row in rows)
    with pytest.raises(TypeError, match=r"save_csv\(\) writes what values\(\) returned"):
        save_csv(recording := [1], tmp_path / "x.csv")  # type: ignore[arg-type]
    assert recording


def test_messages_of_the_same_nanosecond_all_have_their_line(tmp_path: Path) -> None:
    from course_kit.lab.series.value_series import Series

    series = Series("/a.x", np.array([5, 5, 6]), np.array([1.0, 2.0, 3.0]), 5)
    lines = save_csv(Values([series]), tmp_path / "out.csv").read_text().splitlines()
    assert lines[1:] == ["0.000000000,1.0", "0.000000000,2.0", "0.000000001,3.0"]


def test_a_plot_has_a_row_a_path_or_all_in_one(robot: Node) -> None:
    there = values("/turtle1/pose.x", "/turtle1/pose.y", seconds=0.2)
    apart, together = plot_values(there), plot_values(there, together=True, title="Pose")
    assert [axes.get_title(loc="left") for axes in apart.axes] == list(there)
    (axes,) = together.axes
    assert [line.get_label() for line in axes.get_lines()] == list(there)
    drawn = np.asarray(apart.axes[0].get_lines()[0].get_xydata())
    assert drawn[:, 1].tolist() == there["/turtle1/pose.x"].values.tolist()
    low, high = apart.axes[1].get_ylim()  # y is constant
    assert low < 1.0 < high
    assert len(plot_values("/turtle1/pose.theta", seconds=0.1).axes) == 1
    with pytest.raises(TypeError, match=r"plot_values\(\) draws paths and what values\(\) returned, not list"):
        plot_values([1])  # type: ignore[arg-type]
    with record("/nothing", Pose) as recording:
        pass
    with pytest.raises(ValueError, match="no message came"):
        plot_values("/nothing.x", source=recording)
