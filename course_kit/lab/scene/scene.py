"""Scans, paths, maps and poses as points of a plane, in one frame. Pure numpy, no ROS.

Frames follow REP 103: x forward, y left, z up, angles counter-clockwise. A message lies in the frame of its header;
messages that say where another frame is (Odometry, TransformStamped, TFMessage) make layers of both frames fit. What
they say of the moment of a layer is tf2's affair, course_kit/robots/tf.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from course_kit.lab.scene.frames import Frames, stamp_of
from course_kit.robots.tf.link_history import NEVER

Float64s = npt.NDArray[np.float64]
NEAR = 100_000_000  # ns beyond what is known of a frame, from which it is said
UNKNOWN = -1  # of a map's cells; 0 is free for certain, 100 occupied for certain


@dataclass(frozen=True)
class Layer:
    """One message in its own frame. What it has not is empty."""

    label: str
    frame: str
    kind: str  # scan, path, grid, poses, points
    points: Float64s = field(default_factory=lambda: np.empty((0, 3)))  # m, shape (points, 3)
    poses: Float64s = field(default_factory=lambda: np.empty((0, 4, 4)))  # matrices, shape (poses, 4, 4)
    cells: npt.NDArray[np.int8] | None = None  # shape (height, width): [0, 0] is the corner at the map's origin
    resolution: float = 0.0  # m, the side of a cell
    note: str = ""  # what is odd about it
    stamp: int = NEVER  # ns; when it was so, NEVER if that is not said

    def placed(self, where: Float64s, frame: str) -> Layer:
        """The same in another frame; `where` is the pose of its own there, as a matrix."""
        points = self.points @ where[:3, :3].T + where[:3, 3]
        return replace(self, frame=frame, points=points, poses=where @ self.poses)


def matrix(position: Any, orientation: Any) -> Float64s:
    """A pose as a 4 by 4 matrix, from a position x, y, z and a quaternion; one of zeros counts as no turn."""
    q = np.array([orientation.x, orientation.y, orientation.z, orientation.w], np.float64)
    length = float(np.linalg.norm(q))
    x, y, z, w = q / length if length > 1e-9 else (0.0, 0.0, 0.0, 1.0)
    result = np.eye(4)
    result[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    result[:3, 3] = position.x, position.y, position.z
    return result


def _of_pose(pose: Any) -> Float64s:
    return matrix(pose.position, pose.orientation)


def _stack(poses: Iterable[Any]) -> Float64s:
    return np.array([_of_pose(pose) for pose in poses], np.float64).reshape(-1, 4, 4)


def _scan(message: Any, label: str) -> Layer:
    ranges = np.asarray(message.ranges, np.float64)
    angles = message.angle_min + np.arange(len(ranges)) * message.angle_increment
    # REP 117: infinite is nothing in reach, nan is no measurement.
    hits = np.isfinite(ranges) & (ranges >= message.range_min) & (ranges <= message.range_max)
    far, angles = ranges[hits], angles[hits]
    points = np.column_stack([far * np.cos(angles), far * np.sin(angles), np.zeros(len(far))])
    note = "" if hits.any() or not len(ranges) else "none of its ranges lies between range_min and range_max"
    return Layer(label, message.header.frame_id, "scan", points, np.eye(4)[None], note=note)


def _path(message: Any, label: str) -> Layer:
    poses = _stack(one.pose for one in message.poses)
    others = {one.header.frame_id for one in message.poses} - {message.header.frame_id, ""}
    note = f"some of its poses say frame '{min(others)}'" if others else ""
    return Layer(label, message.header.frame_id, "path", poses[:, :3, 3], poses, note=note)


def _grid(message: Any, label: str) -> Layer:
    info = message.info
    cells = np.asarray(message.data, np.int8)
    if len(cells) != info.width * info.height:
        raise ValueError(f"{label} has {len(cells)} cells, but its info says {info.width} by {info.height}")
    if not len(cells) or info.resolution <= 0:
        raise ValueError(f"{label} has no cells, or a resolution of {info.resolution:g} m: there is nothing to draw")
    cells = cells.reshape(info.height, info.width)
    odd = int(((cells < UNKNOWN) | (cells > 100)).sum())
    note = f"{odd:,} of its cells are outside -1 to 100 and drawn as unknown" if odd else ""
    width, height = info.width * info.resolution, info.height * info.resolution
    corners = np.array([[0, 0, 0], [width, 0, 0], [width, height, 0], [0, height, 0]], np.float64)
    frame = message.header.frame_id
    at_origin = Layer(label, frame, "grid", corners, np.eye(4)[None], cells, float(info.resolution), note)
    return at_origin.placed(_of_pose(info.origin), frame)


def _poses(read: Callable[[Any], Iterable[Any]], message: Any, label: str) -> Layer:
    poses = _stack(read(message))
    return Layer(label, message.header.frame_id, "poses", poses[:, :3, 3], poses)


def _points(read: Callable[[Any], Iterable[Any]], message: Any, label: str) -> Layer:
    points = np.array([(p.x, p.y, p.z) for p in read(message)], np.float64).reshape(-1, 3)
    return Layer(label, message.header.frame_id, "points", points)


READERS: dict[str, Callable[[Any, str], Layer]] = {
    "sensor_msgs/msg/LaserScan": _scan,
    "nav_msgs/msg/Path": _path,
    "nav_msgs/msg/OccupancyGrid": _grid,
    "geometry_msgs/msg/PoseArray": partial(_poses, lambda message: message.poses),
    "geometry_msgs/msg/PoseStamped": partial(_poses, lambda message: [message.pose]),
    "geometry_msgs/msg/PoseWithCovarianceStamped": partial(_poses, lambda message: [message.pose.pose]),
    "nav_msgs/msg/Odometry": partial(_poses, lambda message: [message.pose.pose]),
    "geometry_msgs/msg/PointStamped": partial(_points, lambda message: [message.point]),
    "geometry_msgs/msg/PolygonStamped": partial(
        _points, lambda message: [*message.polygon.points, *message.polygon.points[:1]]
    ),
}


def layer(message: Any, type_name: str, label: str) -> Layer:
    """The layer of a message. ValueError for a type that has no place in the plane."""
    if type_name not in READERS:
        raise ValueError(f"{label} is a {type_name}: plot_scene() draws {', '.join(READERS)}")
    return replace(READERS[type_name](message, label), stamp=stamp_of(message))


@dataclass(frozen=True)
class Scene:
    """Layers in one frame, and one line for each thing that does not fit."""

    frame: str
    layers: list[Layer]
    axes: dict[str, Float64s]  # the poses of the frames that are known, by name
    notes: list[str]


def scene(layers: list[Layer], frames: Frames, frame: str | None = None) -> Scene:
    """Put layers into `frame`, or that of the first, each where it was at its stamp. ValueError if none can be put."""
    inside = _frame_of(layers, frame)
    drawn: list[Layer] = []
    notes = [f"{one.label}: {one.note}" for one in layers if one.note]
    apart: dict[str, list[str]] = {}
    for one in layers:
        if not one.frame and inside:
            notes.append(f"{one.label} has no frame_id: drawn as if it were in '{inside}'")
        if one.frame in ("", inside):
            drawn.append(one.placed(np.eye(4), inside))
        elif (place := frames.place(inside, one.frame, one.stamp)) is None:
            apart.setdefault(one.frame, []).append(one.label)
        else:
            drawn.append(one.placed(place, inside))
            if late := frames.beyond(inside, one.frame, one.stamp, NEAR):
                notes.append(f"{one.label} is {late}: drawn as if it were still so")
    notes += [
        f"not drawn: {', '.join(labels)} in frame '{name}', and no message says where that is in '{inside}'"
        for name, labels in apart.items()
    ]
    if not drawn:
        raise ValueError("; ".join(notes) or "there is nothing to draw: give messages or topics")
    places = frames.places(inside, max(one.stamp for one in layers)) if inside else {}
    return Scene(inside, drawn, {inside: np.eye(4), **places} if inside else {}, notes)


def is_known(layers: list[Layer], frames: Frames, frame: str | None = None) -> bool:
    """Return True if the frames tell where each layer was at its stamp."""
    inside = _frame_of(layers, frame)
    return all(
        frames.place(inside, one.frame, one.stamp) is not None and not frames.beyond(inside, one.frame, one.stamp)
        for one in layers
        if one.frame not in ("", inside)
    )


def _frame_of(layers: list[Layer], frame: str | None) -> str:
    return frame or next((one.frame for one in layers if one.frame), "")
