"""A laser scanner on a turtle: it measures how far the walls and a pillar are, as a scanner on a robot does.

An example to read. The geometry is distances(), which knows no ROS; the node takes a pose and publishes a scan.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from turtlesim.msg import Pose

WALLS = 11.09  # metres from wall to wall, both ways: the turtle is held a millimetre before
PERIOD = 0.1  # seconds from scan to scan
BEAMS = 181  # one in two degrees; the first and the last point backwards
LONGEST = 16.0  # metres; a little more than from corner to corner
PILLAR, RADIUS = (8.0, 8.0), 0.8  # metres: where the pillar stands in the turtle's world, and how thick it is
ANGLES = np.linspace(-math.pi, math.pi, BEAMS)  # of the beams, seen from the turtle: 0 is ahead, π/2 to the left

Floats = npt.NDArray[np.float64]


class Laser(Node):
    """The node laser: ten scans a second on /scan, measured from turtle1; takes the keyword arguments of Node."""

    def __init__(self, **options: Any) -> None:
        super().__init__("laser", **options)
        self.pose: Pose | None = None
        self.publisher = self.create_publisher(LaserScan, "scan", qos_profile_sensor_data)
        self.create_subscription(Pose, "turtle1/pose", self.on_pose, 1)
        self.create_timer(PERIOD, self.measure)

    def on_pose(self, pose: Pose) -> None:
        """Take over where the turtle is now."""
        self.pose = pose

    def measure(self) -> None:
        """Publish a scan from there, once it is known where the turtle is."""
        if self.pose is None:
            return
        scan = LaserScan(angle_min=-math.pi, angle_max=math.pi, angle_increment=2 * math.pi / (BEAMS - 1))
        scan.range_max, scan.scan_time = LONGEST, PERIOD
        scan.header.frame_id = "turtle1"
        scan.header.stamp = self.get_clock().now().to_msg()
        scan.ranges = distances(self.pose.x, self.pose.y, self.pose.theta + ANGLES).tolist()
        self.publisher.publish(scan)


def distances(x: float, y: float, angles: Floats) -> Floats:
    """Metres from a place to the first wall, or the pillar, in each direction; angles in radians, 0 is east."""
    east, north = np.cos(angles), np.sin(angles)
    with np.errstate(divide="ignore", invalid="ignore"):  # a beam along a wall never meets it
        to_side = np.where(east > 0, WALLS - x, x) / np.abs(east)
        to_end = np.where(north > 0, WALLS - y, y) / np.abs(north)
    return np.fmin.reduce([to_side, to_end, _to_pillar(x, y, east, north)])


def _to_pillar(x: float, y: float, east: Floats, north: Floats) -> Floats:
    """The same to the pillar alone, a circle: infinite in directions that miss it."""
    # How far along the beam its point nearest to the centre lies, and how far inside the circle that is.
    along = east * (PILLAR[0] - x) + north * (PILLAR[1] - y)
    inside = RADIUS**2 - math.dist(PILLAR, (x, y)) ** 2 + along**2
    return np.where((along > 0) & (inside > 0), along - np.sqrt(np.maximum(inside, 0.0)), np.inf)
