"""Scans, paths, maps and poses in one frame: where each point lies, and what is said of what does not fit."""

from __future__ import annotations

import math
import threading
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import Point, PointStamped, Pose, PoseArray, PoseStamped, Quaternion, TransformStamped
from matplotlib.backends.backend_agg import FigureCanvasAgg
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import serialize_message
from rclpy.time import Time
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Header, String
from tf2_msgs.msg import TFMessage
from tf2_ros import StaticTransformBroadcaster, TransformBroadcaster

from course_kit.lab.recordings.buffers import MessageBuffer
from course_kit.lab.recordings.topic_recording import TopicRecording
from course_kit.lab.scene.frames import Frames
from course_kit.lab.scene.scene import layer, matrix, scene
from course_kit.lab.scene.scene_plots import FREE, NOT_KNOWN, OCCUPIED, plot_scene, shades
from course_kit.ros.spinning import context
from course_kit.ros.subscriptions import topics
from tests.waiting import wait_until


def turned(yaw: float) -> Quaternion:
    return Quaternion(z=math.sin(yaw / 2), w=math.cos(yaw / 2))


def pose(x: float, y: float, yaw: float = 0.0) -> Pose:
    return Pose(position=Point(x=x, y=y), orientation=turned(yaw))


def scan(*ranges: float, frame: str = "base_link", step: float = math.pi / 2) -> LaserScan:
    return LaserScan(
        header=Header(frame_id=frame), angle_min=0.0, angle_increment=step, range_min=0.1, range_max=10.0, ranges=ranges
    )


def grid(frame: str = "map", origin: Pose | None = None) -> OccupancyGrid:
    """3 by 2 cells of half a metre: free, occupied, unknown below; half, odd, free above."""
    message = OccupancyGrid(header=Header(frame_id=frame), data=[0, 100, -1, 50, 120, 0])
    message.info.width, message.info.height, message.info.resolution = 3, 2, 0.5
    message.info.origin = origin or pose(0.0, 0.0)
    return message


def placed(*messages: Any, frame: str | None = None) -> Any:
    frames, layers = Frames(), []
    for number, message in enumerate(messages):
        kind = topics.type_name(type(message))
        frames.add(message, kind)
        if not isinstance(message, TransformStamped):
            layers.append(layer(message, kind, f"layer {number}"))
    return scene(layers, frames, frame)


def test_a_scan_counts_from_the_front_to_the_left() -> None:
    """REP 103: x forward, y left, angles counter-clockwise; REP 117: infinite is no hit."""
    (one,) = placed(scan(1.0, 2.0, math.inf, 3.0, 0.01, 99.0, math.nan)).layers
    assert one.points[:, :2] == pytest.approx(np.array([[1, 0], [0, 2], [0, -3]]), abs=1e-5)


def test_a_map_begins_at_its_origin_and_turns_about_it() -> None:
    (one,) = placed(grid(origin=pose(2.0, 1.0, math.pi / 2))).layers
    # 1.5 m along its x axis, which looks along the frame's y axis; 1 m along its y axis.
    assert one.points[:, :2] == pytest.approx(np.array([[2, 1], [2, 2.5], [1, 2.5], [1, 1]]), abs=1e-9)
    assert one.cells.tolist() == [[0, 100, -1], [50, 120, 0]]
    assert "1 of its cells" in one.note


def test_each_cell_of_a_map_is_drawn_at_its_place() -> None:
    figure = plot_scene(grid(origin=pose(2.0, 1.0, math.pi / 2)), scan(1.0, frame="map"))
    axes = figure.axes[0]
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())

    def colour(x: float, y: float) -> str:
        column, row = axes.transData.transform((x, y))
        red, green, blue, _ = pixels[pixels.shape[0] - 1 - int(row), int(column)]
        return f"#{red:02x}{green:02x}{blue:02x}"

    # The centre of cell [row, column] lies at origin + turned((column + 0.5) / 2, (row + 0.5) / 2).
    centres = {
        (row, column): (2.0 - (row + 0.5) * 0.5 + 0.08, 1.0 + (column + 0.5) * 0.5 + 0.08)
        for row in (0, 1)
        for column in (0, 1, 2)
    }
    seen = {place: colour(*centre) for place, centre in centres.items()}
    assert seen[0, 0] == seen[1, 2] == FREE
    assert seen[0, 1] == OCCUPIED
    assert seen[0, 2] == seen[1, 1] == NOT_KNOWN
    assert seen[1, 0] not in (FREE, OCCUPIED, NOT_KNOWN)
    assert axes.get_aspect() == 1.0


def test_the_more_occupied_the_darker() -> None:
    row = shades(np.arange(101, dtype=np.int8)[None])[0].astype(int)
    assert np.all(np.diff(row[:, :3].sum(axis=1)) <= 0) and np.all(row[:, 3] == 255)


def test_an_odometry_places_what_lies_in_its_child_frame() -> None:
    odometry = Odometry(header=Header(frame_id="odom"), child_frame_id="base_link")
    odometry.pose.pose = pose(2.0, 1.0, math.pi / 2)
    both = placed(odometry, scan(1.0))
    assert both.frame == "odom" and both.notes == []
    assert both.layers[1].points[0, :2] == pytest.approx([2, 2])
    # And the other way round: seen from the robot, the origin of odom lies behind, to the left.
    other = placed(odometry, PointStamped(header=Header(frame_id="odom")), frame="base_link")
    assert other.layers[1].points[0, :2] == pytest.approx([-1, 2])


def test_transforms_are_followed_over_several_frames() -> None:
    def transform(parent: str, child: str, x: float) -> TransformStamped:
        message = TransformStamped(header=Header(frame_id=parent), child_frame_id=child)
        message.transform.translation.x = x
        return message

    chain = [transform("map", "odom", 10.0), transform("odom", "base_link", 5.0)]
    assert placed(*chain, scan(1.0), frame="map").layers[0].points[0, :2] == pytest.approx([16, 0])


def moved(parent: str, child: str, x: float, stamp: float, yaw: float = 0.0) -> TransformStamped:
    message = TransformStamped(header=at(stamp, parent), child_frame_id=child)
    message.transform.translation.x, message.transform.rotation = x, turned(yaw)
    return message


def at(stamp: float, frame: str) -> Header:
    return Header(frame_id=frame, stamp=Time(seconds=stamp).to_msg())


def recording(topic: str, messages: Sequence[Any]) -> TopicRecording:
    buffer = MessageBuffer([topic])
    append = buffer.appender(topic)
    for number, message in enumerate(messages):
        append(serialize_message(message), number)
    return TopicRecording(topic, type(messages[0]), buffer.snapshot(topic), 0)


def test_a_layer_is_put_where_its_frame_was_at_its_stamp() -> None:
    """The robot drives a metre and turns by a right angle between 10 s and 12 s; half of both at 11 s."""
    drive = [moved("odom", "base_link", 1.0, 10.0), moved("odom", "base_link", 2.0, 12.0, math.pi / 2)]
    fixed = [moved("base_link", "laser", 0.5, 0.0)]
    for stamp, expected in {
        10.0: (2.5, 0.0),
        11.0: (1.5 + 1.5 * math.cos(math.pi / 4), 1.5 * math.sin(math.pi / 4)),
        12.0: (2.0, 1.5),
        0.0: (2.0, 1.5),  # without a stamp: where it is last
    }.items():
        seen = scan(1.0, frame="laser")
        seen.header = at(stamp, "laser")
        both = placed(*drive, *fixed, seen, frame="odom")
        assert both.layers[0].points[0, :2] == pytest.approx(expected, abs=1e-6)
        assert both.notes == []


def test_a_layer_whose_moment_is_not_known_is_drawn_and_named() -> None:
    drive = [moved("odom", "base_link", 1.0, 10.0), moved("odom", "base_link", 2.0, 12.0)]
    for stamp, x, told in ((13.5, 3.0, "1.50 s later than the last"), (9.75, 2.0, "0.25 s earlier than the first")):
        seen = scan(1.0)
        seen.header = at(stamp, "base_link")
        both = placed(*drive, seen, frame="odom")
        assert both.layers[0].points[0, 0] == pytest.approx(x)
        note = f"layer 2 is {told} that is known of 'base_link' in 'odom': drawn as if it were still so"
        assert both.notes == [note]
        # Links that are above both frames do not matter.
        assert len(placed(moved("map", "odom", 0.0, 1.0), moved("map", "odom", 0.0, 2.0), *drive, seen).notes) == 0


def test_a_transform_counts_more_than_an_odometry() -> None:
    odometry = Odometry(header=at(10.0, "odom"), child_frame_id="base_link")
    odometry.pose.pose = pose(5.0, 0.0)
    transforms = [moved("odom", "base_footprint", 1.0, 10.0), moved("base_footprint", "base_link", 0.0, 0.0)]
    assert placed(odometry, *transforms, scan(1.0), frame="odom").layers[1].points[0, 0] == pytest.approx(2.0)


def test_all_of_a_recording_of_tf_tells_where_frames_were() -> None:
    drive = [TFMessage(transforms=[moved("odom", "base_link", step * 0.1, 10 + step * 0.1)]) for step in range(21)]
    static = [TFMessage(transforms=[moved("base_link", "laser", 0.5, 0.0)])]
    seen = scan(1.0, frame="laser")
    seen.header = at(11.05, "laser")
    told = repr(plot_scene(recording("/tf", drive), recording("/tf_static", static), scan=seen, frame="odom"))
    assert "Frame 'laser' is at (1.55, 0.00) m" in told and "Frame 'base_link' is at (1.05, 0.00) m" in told


def test_frames_that_are_near_each_other_are_drawn_as_one() -> None:
    parts = [moved("base_link", f"part_{number}", 0.01 * number, 0.0) for number in range(5)]
    figure = plot_scene(*parts, moved("odom", "base_link", 1.0, 0.0), scan(2.0, 1.0), frame="odom")
    (label,) = figure.axes[0].texts
    assert label.get_text() == "base_link\nand 5 more"


def test_a_layer_of_another_frame_is_left_out_and_named_in_one_line() -> None:
    figure = plot_scene(grid=grid(), scan=scan(1.0))
    below = figure.get_supxlabel()
    assert "not drawn: scan in frame 'base_link', and no message says where that is in 'map'" in below
    labels = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]  # type: ignore[union-attr]
    assert labels == ["grid: free", "occupied", "unknown"]
    with pytest.raises(ValueError, match=r"not drawn: .* in frame 'base_link'"):
        plot_scene(scan(1.0), frame="map")


def test_a_message_without_a_frame_is_drawn_and_named() -> None:
    assert placed(grid(), scan(1.0, frame="")).notes[-1] == "layer 1 has no frame_id: drawn as if it were in 'map'"


def test_paths_and_poses_look_along_their_x_axis() -> None:
    path = Path(header=Header(frame_id="map"), poses=[PoseStamped(pose=pose(x, 0.0)) for x in (0.0, 1.0, 2.0)])
    poses = PoseArray(header=Header(frame_id="map"), poses=[pose(0.0, 0.0, math.pi / 2)])
    along, one = placed(path, poses).layers
    assert along.points[:, 0].tolist() == [0, 1, 2]
    assert one.poses[0, :2, 0] == pytest.approx([0, 1], abs=1e-9)
    assert matrix(Point(), Quaternion(x=0.0, y=0.0, z=0.0, w=0.0))[:3, :3].tolist() == np.eye(3).tolist()


@pytest.mark.parametrize(
    ("message", "told"),
    [
        (OccupancyGrid(data=[0, 0]), "has 2 cells, but its info says 0 by 0"),
        (OccupancyGrid(), "has no cells"),
        (String(), r"is a std_msgs/msg/String: plot_scene\(\) draws sensor_msgs/msg/LaserScan"),
    ],
)
def test_what_cannot_be_drawn_is_answered_in_one_line(message: Any, told: str) -> None:
    with pytest.raises(ValueError, match=told) as error:
        plot_scene(message)
    assert "\n" not in str(error.value)


def test_nothing_and_no_message_are_refused() -> None:
    with pytest.raises(TypeError, match="draws messages, topics and recordings, not int"):
        plot_scene(3)
    with pytest.raises(ValueError, match="there is nothing to draw"):
        plot_scene()


def test_topics_are_drawn_by_name_a_latched_map_too() -> None:
    context.start()
    node = Node("map_server")
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_publisher(OccupancyGrid, "/map", latched).publish(grid())
    scans = node.create_publisher(LaserScan, "/scan", 10)
    ended = threading.Event()

    def publish_on() -> None:
        while not ended.wait(0.02):
            scans.publish(scan(1.0, 1.0, frame="map"))

    thread = threading.Thread(target=publish_on)
    thread.start()
    try:
        figure = plot_scene("/map", hits="scan", timeout=20.0)
    finally:
        ended.set()
        thread.join()
        node.destroy_node()
    labels = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]  # type: ignore[union-attr]
    assert labels == ["/map: free", "occupied", "unknown", "hits (2 hits)"]
    assert figure._repr_png_()[0].startswith(b"\x89PNG")


def test_what_tf_says_meanwhile_places_a_topic() -> None:
    """A robot drives at 1 m/s along x; its laser stands 0.5 m before it, and hits a wall at 9 m, from where it is."""
    context.start()
    node = Node("robot")
    scans, frames = node.create_publisher(LaserScan, "/scan", 10), TransformBroadcaster(node)
    StaticTransformBroadcaster(node).sendTransform(moved("base_link", "laser", 0.5, 0.0))
    ended = threading.Event()

    def drive() -> None:
        x = 0.0
        while not ended.wait(0.02):
            x = (x + 0.02) % 4.0
            now = node.get_clock().now().nanoseconds * 1e-9
            frames.sendTransform(moved("odom", "base_link", x, now))
            seen = scan(8.5 - x, frame="laser")
            seen.header = at(now, "laser")
            scans.publish(seen)

    thread = threading.Thread(target=drive)
    thread.start()

    def wall() -> float:
        """Where the wall is drawn."""
        figure = plot_scene("/scan", frame="odom", timeout=20.0)
        (hits,) = [line for line in figure.axes[0].get_lines() if line.get_label() == "/scan (1 hits)"]
        return float(np.asarray(hits.get_xdata())[0])

    try:  # on a busy machine the first scan may come before the first transform
        wait_until(lambda: wall() == pytest.approx(9.0, abs=1e-3))
    finally:
        ended.set()
        thread.join()
        node.destroy_node()
