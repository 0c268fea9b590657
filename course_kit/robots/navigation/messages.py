"""Between ROS messages and what the pure parts take: places, maps, scans, paths."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from geometry_msgs.msg import Pose, PoseStamped, Quaternion, Transform, TransformStamped
from nav_msgs.msg import OccupancyGrid, Path
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import LaserScan

from course_kit.robots.navigation.grid_map import GridMap
from course_kit.robots.navigation.places import Floats, Place

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)  # who comes later gets the last one too


def heading(q: Quaternion) -> float:
    """The turn of a quaternion about z, in rad; it need not be normalised."""
    return math.atan2(2 * (q.w * q.z + q.x * q.y), q.w * q.w + q.x * q.x - q.y * q.y - q.z * q.z)


def turned(angle: float) -> Quaternion:
    """The quaternion of a turn about z."""
    return Quaternion(z=math.sin(angle / 2), w=math.cos(angle / 2))


def place_of(pose: Pose | Transform) -> Place:
    """The place of a pose, or of a frame by its transform, in the plane."""
    if isinstance(pose, Transform):
        return pose.translation.x, pose.translation.y, heading(pose.rotation)
    return pose.position.x, pose.position.y, heading(pose.orientation)


def pose_of(place: Place) -> Pose:
    """A place as pose."""
    pose = Pose(orientation=turned(place[2]))
    pose.position.x, pose.position.y = place[0], place[1]
    return pose


def stamped_pose(place: Place, frame: str, stamp: Any) -> PoseStamped:
    """A place as pose in a frame at a time."""
    message = PoseStamped(pose=pose_of(place))
    message.header.frame_id, message.header.stamp = frame, stamp
    return message


def transform_of(place: Place, parent: str, child: str, stamp: Any) -> TransformStamped:
    """Say that a frame lies at a place of its parent."""
    message = TransformStamped(child_frame_id=child)
    message.header.frame_id, message.header.stamp = parent, stamp
    message.transform.translation.x, message.transform.translation.y = place[0], place[1]
    message.transform.rotation = turned(place[2])
    return message


def rays_of(scan: LaserScan) -> tuple[Floats, Floats]:
    """Angles in rad and ranges in m of a scan, as REP 117 means them: inf saw nothing, nan says nothing."""
    ranges = np.array(scan.ranges, np.float64)
    angles = scan.angle_min + np.arange(len(ranges)) * scan.angle_increment
    ranges[ranges < scan.range_min] = np.nan
    ranges[ranges > scan.range_max] = np.inf
    return angles, ranges


def map_message(grid_map: GridMap, frame: str, stamp: Any) -> OccupancyGrid:
    """A map as message: its first cell is at the origin, then along x, row by row up y."""
    message = OccupancyGrid()
    message.header.frame_id, message.header.stamp = frame, stamp
    message.info.map_load_time = stamp
    message.info.resolution = grid_map.resolution
    message.info.height, message.info.width = grid_map.cells.shape
    message.info.origin = pose_of((*grid_map.origin, 0.0))
    message.data = grid_map.cells.ravel().tolist()
    return message


def map_of(message: OccupancyGrid) -> GridMap:
    """The map of a message. ValueError for one whose numbers do not fit, or that is turned in its frame."""
    info = message.info
    x, y, angle = place_of(info.origin)
    if len(message.data) != info.height * info.width or info.resolution <= 0:
        size = f"{info.width} by {info.height} cells of {info.resolution:g} m"
        raise ValueError(f"the map has {len(message.data)} cells, but its info says {size}")
    if abs(angle) > 1e-3:
        raise ValueError(f"the map is turned by {angle:.3f} rad in its frame: its origin must have no turn")
    cells = np.array(message.data, np.int8).reshape(info.height, info.width)
    return GridMap(cells, round(info.resolution, 6), (x, y))  # resolution is a float32


def path_message(points: Floats, end: float, frame: str, stamp: Any) -> Path:
    """A path as message: each pose looks at the next point, the last one has the heading `end` in rad."""
    message = Path()
    message.header.frame_id, message.header.stamp = frame, stamp
    ways = np.diff(points, axis=0)
    headings = [*np.arctan2(ways[:, 1], ways[:, 0]).tolist(), end]
    for (x, y), angle in zip(points.tolist(), headings, strict=True):
        message.poses.append(stamped_pose((x, y, angle), frame, stamp))
    return message


def points_of(path: Path) -> Floats:
    """The points of a path, shape (n, 2)."""
    return np.array([(one.pose.position.x, one.pose.position.y) for one in path.poses], np.float64).reshape(-1, 2)
