"""A robot's scans on their way: later than their stamps say, as real ones come, and changed as a check wants them."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING

from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan

from course_kit.exercises.checker.assertions import chance
from course_kit.exercises.checker.robot_fixtures import hear_robot, seconds_of
from course_kit.exercises.checker.topic_assertions import publisher

if TYPE_CHECKING:
    from course_kit.robots.robot.node import Robot

LASER = "/laser"
REMAPPED = {"scan": LASER}  # for a_robot(remap=…)


class LateScans:
    """Hands the scans of a robot on LASER on to /scan."""

    def __init__(self, robot: Robot, earliest: float, latest: float, change: Callable[[LaserScan], None]) -> None:
        """`earliest`, `latest`: simulated seconds after its stamp at which one comes; `change` changes it in place."""
        self.sent: list[LaserScan] = []
        self.out = publisher("/scan", LaserScan, qos_profile_sensor_data)
        self._robot, self._late, self._change = robot, (earliest, latest), change
        self._heard = hear_robot(LASER, LaserScan)
        self._waiting: deque[tuple[float, LaserScan]] = deque()
        self._taken = len(self._heard)

    def pass_on(self) -> None:
        """Publish what is due; to be called again and again."""
        for scan in self._heard.messages[self._taken :]:
            self._taken += 1
            self._change(scan)
            self._waiting.append((seconds_of(scan.header.stamp) + chance().uniform(*self._late), scan))
        while self._waiting and self._waiting[0][0] <= self._robot.simulation.time:
            scan = self._waiting.popleft()[1]
            self.out.publish(scan)
            self.sent.append(scan)
