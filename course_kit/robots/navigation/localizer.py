"""The node localizer: where the robot is on a map that somebody publishes, by a particle filter."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from geometry_msgs.msg import PoseArray, PoseWithCovarianceStamped
from nav_msgs.msg import OccupancyGrid
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.time import Time
from sensor_msgs.msg import LaserScan
from std_srvs.srv import Empty
from tf2_ros import TransformBroadcaster

from course_kit.robots.navigation.frames import Frames, PlacedScans
from course_kit.robots.navigation.localization import ParticleFilter
from course_kit.robots.navigation.messages import LATCHED, map_of, place_of, pose_of, rays_of, transform_of
from course_kit.robots.navigation.places import Place, after, between, inverse

AHEAD = Duration(seconds=0.5)  # as the mapper's
MOVED, TURNED = 0.05, 0.05  # m and rad after which a scan is weighed: at rest each would say the same again
SHOWN = 500  # particles that are published, at most
IN_PLANE = (0, 1, 5)  # x, y and the turn about z among the six of a covariance


class Localizer(Node):
    """Publishes /amcl_pose, /particle_cloud and map → odom, from /map, /scan and odometry, on AMCL's names.

    It begins anywhere on the map; where `set_initial_pose` is true, at `initial_pose.x`, `.y` (m) and `.yaw` (rad), and
    after a message on /initialpose there. Takes Node's keyword arguments.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__("localizer", **options)
        self.frames = Frames(self, self.begin)
        self.seed = self.declare_parameter("seed", 0).value
        is_set = self.declare_parameter("set_initial_pose", False).value
        x, y, yaw = (self.declare_parameter(f"initial_pose.{name}", 0.0).value for name in ("x", "y", "yaw"))
        self.start: Place | None = (x, y, yaw) if is_set else None
        self.filter: ParticleFilter | None = None
        self.before: Place | None = None  # of the base in odom, when a scan was weighed last
        self.pose_publisher = self.create_publisher(PoseWithCovarianceStamped, "amcl_pose", LATCHED)
        self.cloud_publisher = self.create_publisher(PoseArray, "particle_cloud", 2)
        self.broadcaster = TransformBroadcaster(self)
        self.create_subscription(OccupancyGrid, "map", self.on_map, LATCHED)
        self.create_subscription(PoseWithCovarianceStamped, "initialpose", self.on_initial_pose, 1)
        self.create_service(Empty, "reinitialize_global_localization", self.on_scatter)
        self.scans = PlacedScans(self, self.frames, self.frames.odom, self.on_scan)

    def on_map(self, message: OccupancyGrid) -> None:
        """Take over a map; particles that are there stay."""
        try:
            grid_map = map_of(message)
        except ValueError as error:
            self.get_logger().error(f"Cannot use /map: {error}")
            return
        if self.filter is None:
            self.filter = ParticleFilter(grid_map, self.seed)
            self.begin()
        else:
            self.filter.map = grid_map

    def begin(self) -> None:
        """Begin with what was said of the robot's place, or anywhere."""
        self.before = None
        if self.filter is not None and self.start is not None:
            self.filter.gather(self.start)
        elif self.filter is not None:
            self.filter.scatter()

    def on_initial_pose(self, message: PoseWithCovarianceStamped) -> None:
        """Somebody says where the robot is, and how sure that is."""
        variances = np.array(message.pose.covariance)[[0, 35]]
        metres, radians = np.sqrt(np.where(variances > 0, variances, 0.25)).tolist()
        self.start, self.before = place_of(message.pose.pose), None
        if self.filter is not None:
            self.filter.gather(self.start, metres, radians)

    def on_scatter(self, _: Empty.Request, response: Empty.Response) -> Empty.Response:
        """Begin anew, anywhere on the map."""
        self.start = None
        self.begin()
        return response

    def on_scan(self, scan: LaserScan, laser: Place) -> None:
        """Weigh the particles by a scan, made where the laser is by odometry, and tell where the robot is."""
        odometry = self.frames.place(self.frames.odom, self.frames.base, scan.header.stamp)
        if self.filter is None or odometry is None:
            return
        step = between(self.before, odometry) if self.before else None
        if step is None or math.hypot(step[0], step[1]) > MOVED or abs(step[2]) > TURNED:
            self.filter.move(step or (0.0, 0.0, 0.0))
            self.filter.weigh(*rays_of(scan), between(odometry, laser))
            self.before = odometry
            self.publish(scan.header.stamp)
        if self.filter.is_together:
            assert self.before is not None
            odom = after(self.filter.place(), inverse(self.before))
            stamp = (Time.from_msg(scan.header.stamp) + AHEAD).to_msg()
            self.broadcaster.sendTransform(transform_of(odom, self.frames.map, self.frames.odom, stamp))

    def publish(self, stamp: Any) -> None:
        """Publish the pose, how sure it is, and the particles."""
        assert self.filter is not None
        message = PoseWithCovarianceStamped()
        message.header.frame_id, message.header.stamp = self.frames.map, stamp
        message.pose.pose = pose_of(self.filter.place())
        covariance = np.zeros((6, 6))
        covariance[np.ix_(IN_PLANE, IN_PLANE)] = self.filter.covariance()
        message.pose.covariance = covariance.ravel()
        self.pose_publisher.publish(message)
        particles = self.filter.particles[:: max(1, len(self.filter.particles) // SHOWN)]
        cloud = PoseArray(header=message.header, poses=[pose_of(tuple(one)) for one in particles.tolist()])
        self.cloud_publisher.publish(cloud)
