"""A robot in a check's test domain: where it is, what it and the answer tell tf, simulated seconds."""

from __future__ import annotations

import contextlib
import math
import os
from collections.abc import Iterator

import pytest
from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from tf2_ros import StaticTransformBroadcaster

from course_kit.exercises.checker import robot_fixtures
from course_kit.exercises.checker.examination import Examination
from course_kit.exercises.in_notebook.answer_host import AnswerHost


class Camera(Node):
    def __init__(self) -> None:
        super().__init__("camera")
        link = TransformStamped(child_frame_id="camera")
        link.header.frame_id = "base_link"
        link.transform.translation.x = 0.1
        self.broadcaster = StaticTransformBroadcaster(self)
        self.broadcaster.sendTransform(link)


@pytest.fixture
def host(examination: Examination) -> Iterator[AnswerHost]:
    with contextlib.closing(AnswerHost(examination.test_domain.domain)) as host:
        yield host
    examination.test_domain.tidy()


def test_a_robot_is_driven_and_tf_tells_where_it_and_the_answers_frames_are(
    examination: Examination, host: AnswerHost
) -> None:
    robot = robot_fixtures.a_robot("empty", start=(3.0, 3.0, 0.0))
    host.start(Camera, "_ros2cli_7", use_sim_time=True)
    assert examination.test_domain.examine("_ros2cli_7", 5.0, os.getpid())
    transforms, scans = robot_fixtures.hear_tf(), robot_fixtures.hear_robot("/scan", LaserScan)
    began = robot.simulation.time
    assert robot_fixtures.drive(robot, 0.2, 0.0, seconds=2.0, timeout=20.0)
    driven = robot.simulation.time - began  # a busy checker sees late that the time is over
    assert driven >= 2.0
    assert robot_fixtures.wait_simulated(robot, 0.5, timeout=20.0)
    x, y, heading = robot.simulation.true_place()
    assert (x, y, heading) == pytest.approx((3.0 + 0.2 * driven - 0.02, 3.0, 0.0), abs=0.03)
    assert robot_fixtures.wait(lambda: transforms.has("odom", "camera"), 5.0)
    place = robot_fixtures.place_in(transforms.buffer(), "odom", "camera")
    assert place is not None
    assert place == pytest.approx((x - 3.0 + 0.1, y - 3.0, heading), abs=0.02)
    at_scan = robot_fixtures.place_in(transforms.buffer(), "odom", "base_scan", scans.messages[0].header.stamp)
    assert at_scan is not None
    assert at_scan[0] < 0.3
    assert robot_fixtures.place_in(transforms.buffer(), "map", "odom") is None
    assert host.node.get_parameter("use_sim_time").value


def test_the_checkers_way_leads_round_the_walls(examination: Examination) -> None:
    robot = robot_fixtures.a_robot("rooms", factor=0.0)
    world = robot.world
    points = robot_fixtures.a_way(world, world.start[:2], world.goals[0])
    assert math.dist(points[-1], world.goals[0]) < 0.1
    assert robot_fixtures.drive_along(robot, points, timeout=30.0)
    assert math.dist(robot.simulation.true_place()[:2], world.goals[0]) < 0.15
    assert not robot.simulation.collisions()
    examination.test_domain.tidy()
