"""Scans, paths, maps and poses in one frame: where each point lies, and what is said of what does not fit."""

from __future__ import annotations

import math
import threading
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import Point, PointStamped, Pose, PoseArray, PoseStamped, Quaternion, TransformStamped
from matplotlib.backends.backend_agg import FigureCanvasAgg
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Header, String

from course_kit.scene.scene import Frames, layer, matrix, scene
from course_kit.scene.scene_plots import FREE, NOT_KNOWN, OCCUPIED, plot_scene, shades
from course_kit.spinning import context
from course_kit.watching import topics


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
