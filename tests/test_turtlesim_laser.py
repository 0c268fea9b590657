"""The laser on a turtle: what it measures from where, and the scan that it publishes."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from turtlesim.msg import Pose

from course_kit.robots.turtlesim.laser import PILLAR, RADIUS, WALLS, Laser, distances
from course_kit.ros.spinning import context
from tests.waiting import wait_until

EAST, NORTH, WEST, SOUTH = 0.0, math.pi / 2, math.pi, -math.pi / 2


def test_the_walls_are_as_far_as_they_are() -> None:
    far = distances(2.0, 3.0, np.array([EAST, NORTH, WEST, SOUTH]))
    assert far == pytest.approx([WALLS - 2.0, WALLS - 3.0, 2.0, 3.0])


def test_into_a_corner_it_is_the_diagonal() -> None:
    assert distances(1.0, 1.0, np.array([-3 * math.pi / 4])) == pytest.approx([math.sqrt(2)])


def test_the_pillar_hides_the_wall_and_only_from_the_side_of_the_turtle() -> None:
    x, y = PILLAR
    assert distances(x - 3.0, y, np.array([EAST, WEST])) == pytest.approx([3.0 - RADIUS, x - 3.0])
    assert distances(x, y - 3.0, np.array([NORTH])) == pytest.approx([3.0 - RADIUS])
    assert distances(x - 3.0, y - RADIUS - 0.01, np.array([EAST])) == pytest.approx([WALLS - x + 3.0])


@pytest.mark.parametrize("place", [(0.0, 0.0), (WALLS - 0.001, 5.0), PILLAR])
def test_no_place_makes_a_distance_that_is_none(place: tuple[float, float]) -> None:
    far = distances(*place, np.linspace(-math.pi, math.pi, 721, dtype=np.float64))
    assert np.all((far >= 0) & np.isfinite(far))


@pytest.fixture
def laser(fresh_domain: None) -> Iterator[Laser]:
    context.start()
    node = Laser()
    yield node
    node.destroy_node()


def test_it_publishes_a_scan_of_where_the_turtle_is_and_none_before(laser: Laser) -> None:
    beside = Node("beside")
    scans: list[LaserScan] = []
    beside.create_subscription(LaserScan, "scan", scans.append, qos_profile_sensor_data)
    poses = beside.create_publisher(Pose, "turtle1/pose", 1)
    executor = SingleThreadedExecutor()
    for node in (laser, beside):
        executor.add_node(node)

    def spun(condition: bool) -> bool:
        executor.spin_once(timeout_sec=0.1)
        return condition

    wait_until(lambda: spun(poses.get_subscription_count() == 1 and laser.publisher.get_subscription_count() == 1))
    for _ in range(3):
        laser.measure()
    executor.spin_once(timeout_sec=0.1)
    assert scans == []
    poses.publish(Pose(x=2.0, y=3.0, theta=NORTH))
    wait_until(lambda: spun(bool(scans)))
    scan = scans[0]
    assert scan.header.frame_id == "turtle1"
    assert scan.header.stamp.sec > 0
    assert (len(scan.ranges), round(scan.angle_min + 180 * scan.angle_increment, 5)) == (181, round(math.pi, 5))
    ahead, left, behind = scan.ranges[90], scan.ranges[135], scan.ranges[0]
    assert [ahead, left, behind] == pytest.approx([WALLS - 3.0, 2.0, 3.0], abs=1e-4)
    executor.shutdown()
    beside.destroy_node()
