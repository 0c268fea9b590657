"""The node mapper: a map of what the laser sees, and where the robot is on it."""

from __future__ import annotations

from typing import Any

from nav_msgs.msg import OccupancyGrid
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.time import Time
from sensor_msgs.msg import LaserScan
from tf2_ros import TransformBroadcaster

from course_kit.robots.navigation.frames import Frames, PlacedScans
from course_kit.robots.navigation.messages import LATCHED, map_message, rays_of, transform_of
from course_kit.robots.navigation.places import Place
from course_kit.robots.navigation.scan_matching import Slam

AHEAD = Duration(seconds=0.5)  # for so long map → odom counts beyond its scan, so that it is there for what comes next


class Mapper(Node):
    """Makes /map from /scan and odometry, and tells tf where odom lies in it; takes Node's keyword arguments.

    Parameters: `resolution` (m), `map_update_interval` (s), `matching` (of scans, else odometry is believed),
    `initial_pose` (x, y in m, heading in rad: where odom lies in the map at first), `map_frame`, `odom_frame`.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__("mapper", **options)
        self.frames = Frames(self, self.on_restart)
        self.resolution = self.declare_parameter("resolution", 0.05).value
        self.matching = self.declare_parameter("matching", True).value
        self.start = tuple(self.declare_parameter("initial_pose", [0.0, 0.0, 0.0]).value)
        interval = self.declare_parameter("map_update_interval", 1.0).value
        self.slam: Slam | None = None
        self.publisher = self.create_publisher(OccupancyGrid, "map", LATCHED)
        self.broadcaster = TransformBroadcaster(self)
        self.scans = PlacedScans(self, self.frames, self.frames.odom, self.on_scan)
        self.create_timer(interval, self.publish)

    def on_restart(self) -> None:
        """Begin a new map."""
        self.slam = None

    def on_scan(self, scan: LaserScan, odometry: Place) -> None:
        """Take over a scan, made where the laser is by odometry."""
        if self.slam is None:
            self.slam = Slam(self.start, self.resolution, self.matching)
        self.slam.update(odometry, *rays_of(scan), scan.range_max)
        stamp = (Time.from_msg(scan.header.stamp) + AHEAD).to_msg()
        self.broadcaster.sendTransform(transform_of(self.slam.odom, self.frames.map, self.frames.odom, stamp))

    def publish(self) -> None:
        """Publish the map as it is now."""
        if self.slam is not None:
            now = self.get_clock().now().to_msg()
            self.publisher.publish(map_message(self.slam.grid.map(), self.frames.map, now))
