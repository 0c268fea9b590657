"""Disturbs the lab's robot and looks at its reactions: a turtle put elsewhere, a speed limit, more scans.

Rates alone could come from anything that publishes. For checks only: it moves the student's turtle, and gives back the
limit that the map server had given.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from random import Random
from statistics import median
from typing import Any, NamedTuple

from geometry_msgs.msg import Twist
from nav_msgs.srv import GetMap
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Float32, Int32
from turtlesim.msg import Pose
from turtlesim.srv import TeleportAbsolute

from course_kit.exercises.checker.service_assertions import Client
from course_kit.exercises.faults.health import RATE
from course_kit.exercises.protocol.verdict import Finding
from course_kit.ros.observing.domain_observer import DomainObserver
from course_kit.ros.observing.received_messages import ReceivedMessages

Wait = Callable[[Callable[[], object], float], object]

WALLS = 11.09  # metres, both ways
LIMIT = 1.0  # m/s, the map server's
TIMEOUT = 8.0  # seconds for each reaction; it takes a tenth of that, unless the machine is busy
TRIES = 4  # times in it that the speed limit is told
NEAR = 0.5  # metres, that it may have driven since
OFF = 0.15  # metres, or m/s
AGE = 0.35e9  # nanoseconds between a pose and the scan from there, at most
BEAMS = 36
MAP_PERIOD = 0.5  # seconds
MORE = 1.25  # times the rate that the map gets at least of twice the scans, with a short queue too


class Place(NamedTuple):
    """Where a turtle is put."""

    x: float
    y: float
    theta: float


def open_place(chance: Random) -> Place:
    """One with room on all sides."""
    return Place(chance.uniform(3.5, 7.5), chance.uniform(3.5, 7.5), chance.uniform(-3.0, 3.0))


def place_at_a_wall(chance: Random) -> Place:
    """One that faces a wall."""
    side, along = chance.randrange(4), chance.uniform(4.0, 7.0)
    gap = chance.uniform(0.6, 1.0)
    x, y = ((WALLS - gap, along), (along, WALLS - gap), (gap, along), (along, gap))[side]
    return Place(x, y, math.remainder(side * math.pi / 2 + chance.uniform(-0.2, 0.2), math.tau))


def distance_to_wall(pose: Any, angle: float) -> float:
    """Metres from a pose to the first wall in a direction, 0 is ahead."""
    x, y = math.cos(pose.theta + angle), math.sin(pose.theta + angle)
    to_side = (WALLS - pose.x) / x if x > 0 else -pose.x / x if x < 0 else math.inf
    to_end = (WALLS - pose.y) / y if y > 0 else -pose.y / y if y < 0 else math.inf
    return min(to_side, to_end)


def is_from(scan: Any, pose: Any) -> bool:
    """Return True if a scan was taken at a pose, but for some beams: near a corner a little makes much."""
    off = [
        abs(d - distance_to_wall(pose, scan.angle_min + n * scan.angle_increment)) for n, d in enumerate(scan.ranges)
    ]
    return bool(off) and median(off) <= OFF


class Robot:
    """The robot of a domain, its inputs and outputs."""

    def __init__(self, observer: DomainObserver, wait: Wait) -> None:
        self._observer, self._wait = observer, wait
        kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self._limits = observer.check_node.create_publisher(Float32, "/speed_limit", kept)
        self._poses = observer.listen("/turtle1/pose", Pose)
        self._scans = observer.listen("/scan", LaserScan)
        self._commands = observer.listen("/turtle1/cmd_vel", Twist)
        self._counts = observer.listen("/map_scans", Int32)
        self._teleport = Client("/turtle1/teleport_absolute", TeleportAbsolute, observer)
        self._began, self._limit = time.time_ns(), LIMIT
        observer.on_own_node(self._add_scans)

    def _add_scans(self, node: Node) -> None:
        """Publish as many scans as the scanner does, from where the turtle is."""
        extra = node.create_publisher(LaserScan, "/scan", qos_profile_sensor_data)
        step = math.tau / BEAMS

        def publish() -> None:
            if len(self._poses):
                pose = self._poses.last
                scan = LaserScan(angle_min=-math.pi, angle_increment=step, range_max=2 * WALLS)
                scan.ranges = [distance_to_wall(pose, scan.angle_min + beam * step) for beam in range(BEAMS)]
                scan.header.stamp = node.get_clock().now().to_msg()
                extra.publish(scan)

        node.create_timer(1.0 / RATE, publish)

    def limit(self, speed: float) -> None:
        """Tell it how fast it may drive."""
        self._limit = speed
        self._limits.publish(Float32(data=speed))
        self._limits.wait_for_all_acked(Duration(seconds=1.0))

    def put(self, place: Place) -> bool:
        """Teleport its turtle; whether the turtle was there, and a scan came from where it was then."""
        began = time.time_ns()
        self._teleport.ask(**place._asdict())

        def is_there() -> bool:
            poses = _since(self._poses, began)
            if not any(math.dist((pose.x, pose.y), place[:2]) <= NEAR for _, pose in poses):
                return False
            return any(
                is_from(scan, pose)
                for taken, scan in self._scanned(began)
                for when, pose in poses
                if taken - AGE <= when <= taken and math.dist((pose.x, pose.y), place[:2]) <= NEAR
            )

        return bool(self._wait(is_there, TIMEOUT))

    def _scanned(self, since: int) -> list[tuple[int, Any]]:
        """The robot's own scans."""
        ends = {bytes(end.endpoint_gid) for end in self._observer.publishers("/scan")}
        return [(when, scan) for when, scan in self._scans.of(ends) if when >= since]

    def does(self, fits: Callable[[Any], bool], speed: float = math.nan) -> bool:
        """Wait until its commands fit, and until its turtle has a speed, if one is given."""
        began = time.time_ns()

        def is_done() -> bool:
            commands, poses = _since(self._commands, began), _since(self._poses, began)
            is_driving = math.isnan(speed) or any(
                abs(pose.linear_velocity - speed) <= 0.05 * speed for _, pose in poses
            )
            return is_driving and any(fits(command) for _, command in commands[-3:])

        for _ in range(TRIES):
            if self._wait(is_done, TIMEOUT / TRIES):
                return True
            self.limit(self._limit)  # a map server that was just started may have told its own meanwhile
        return False

    def counts_more(self) -> bool:
        """Return True if the map grows by more scans since there are twice as many."""

        def grows() -> bool:
            counted = _since(self._counts, self._began + int(2 * MAP_PERIOD * 1e9))
            if len(counted) < 2:
                return False
            (first, before), (last, after) = counted[0], counted[-1]
            seconds = (last - first) * 1e-9
            return seconds > 1.9 * MAP_PERIOD and after.data - before.data >= MORE * RATE * seconds

        return bool(self._wait(grows, TIMEOUT))

    def hands_out_a_map(self) -> bool:
        """Return True if it answers who asks for its map."""
        response = Client("/get_map", GetMap, self._observer).ask().response
        return response is not None and 0 < len(response.map.data) == response.map.info.width * response.map.info.height


def _since(heard: ReceivedMessages, began: int) -> list[tuple[int, Any]]:
    return [(when, message) for when, message in heard.arrivals if when >= began]


def examine(observer: DomainObserver, wait: Wait, chance: Random) -> list[Finding]:
    """What is found in a robot that is well as far as its rates tell, up to the first thing that is wrong."""
    robot, seen = Robot(observer, wait), []
    try:
        for finding in _reactions(robot, chance):
            seen.append(finding)
            if not finding.ok:
                break
    finally:
        robot.limit(LIMIT)
    return seen


def _reactions(robot: Robot, chance: Random) -> Iterator[Finding]:
    """One thing after the other; each is only tried when it is asked for."""
    scans = "its scans are from where its turtle is put", "Who publishes `/turtle1/pose` and `/scan`?"
    commands = "`/turtle1/cmd_vel` and the speed of the turtle should follow"
    limit = chance.uniform(0.35, 0.5)

    def drives(command: Any) -> bool:
        return abs(command.linear.x - limit) <= 0.05 * limit and command.angular.z == 0.0

    def turns(command: Any) -> bool:
        return 0.0 < command.linear.x <= 1.05 * limit and command.angular.z != 0.0

    robot.limit(limit)
    yield Finding(scans[0], robot.put(open_place(chance)), scans[1])
    hint = f"There is room, and its speed limit is {limit:.2f} m/s: {commands}."
    yield Finding("it drives where there is room, as fast as it may", robot.does(drives, speed=limit), hint)
    limit = chance.uniform(0.15, 0.25)
    robot.limit(limit)
    yield Finding(scans[0], robot.put(place_at_a_wall(chance)), scans[1])
    hint = f"It faces a wall, and its speed limit is {limit:.2f} m/s: {commands}."
    yield Finding("it turns where there is no room, no faster than it may", robot.does(turns), hint)
    hint = "`/map_scans` did not grow faster when more scans came."
    yield Finding("twice the scans get into the map", robot.counts_more(), hint)
    hint = "No map came: `%ros2 service info /get_map` counts its servers."
    yield Finding("`/get_map` is answered", robot.hands_out_a_map(), hint)
