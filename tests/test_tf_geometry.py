"""Messages in other frames: each type of tf2_geometry_msgs, and what Buffer.transform() does with registered types.

As tf2_ros, tf2_geometry_msgs and tf2_sensor_msgs it imports course_kit.robots.tf.buffer, course_kit.robots.tf.clouds,
course_kit.robots.tf.geometry and course_kit.robots.tf.registration.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import tf2_geometry_msgs as geometry
import tf2_sensor_msgs as sensor
from geometry_msgs.msg import (
    Point,
    PointStamped,
    PoseStamped,
    PoseWithCovarianceStamped,
    TransformStamped,
    Vector3Stamped,
    WrenchStamped,
)
from rclpy.duration import Duration
from rclpy.time import Time
from sensor_msgs.msg import PointCloud2, PointField
from std_msgs.msg import String
from tf2_ros import Buffer, BufferInterface, ExtrapolationException, NotImplementedException, TypeException
from tf2_ros import buffer_interface as registered

from tests.transforms import at

# The laser sits 1 m ahead of the base and 2 m up, and looks to its left.
LASER = at("laser", "base", 5.0, x=1.0, yaw=math.pi / 2)
LASER.transform.translation.z = 2.0


def in_laser(kind: type, seconds: float = 5.0) -> Any:
    message = kind()
    message.header.frame_id = "laser"
    message.header.stamp = Time(nanoseconds=round(seconds * 1e9)).to_msg()
    return message


def numbers(message: Any) -> tuple[float, float, float]:
    return message.x, message.y, message.z


@pytest.fixture
def buffer() -> Buffer:
    buffer = Buffer()
    buffer.set_transform(LASER, "test")
    return buffer


def test_a_point_is_turned_and_shifted(buffer: Buffer) -> None:
    point = in_laser(PointStamped)
    point.point.x = 3.0
    found = buffer.transform(point, "base")
    assert numbers(found.point) == pytest.approx((1.0, 3.0, 2.0))
    assert (found.header.frame_id, found.header.stamp) == ("base", point.header.stamp)
    assert numbers(point.point) == (3.0, 0.0, 0.0)


def test_a_vector_is_turned_alone() -> None:
    vector = in_laser(Vector3Stamped)
    vector.vector.x = 3.0
    assert numbers(geometry.do_transform_vector3(vector, LASER).vector) == pytest.approx((0.0, 3.0, 0.0))
    assert LASER.transform.translation.z == 2.0  # of the transform nothing is changed


def test_a_pose_is_turned_and_shifted(buffer: Buffer) -> None:
    pose = in_laser(PoseStamped)
    pose.pose.position.x = 3.0
    pose.pose.orientation.z = pose.pose.orientation.w = math.sqrt(0.5)
    for found in (buffer.transform(pose, "base").pose, geometry.do_transform_pose(pose.pose, LASER)):
        assert numbers(found.position) == pytest.approx((1.0, 3.0, 2.0))
        turn = found.orientation
        assert (abs(turn.z), abs(turn.w)) == pytest.approx((1.0, 0.0))


def test_how_sure_a_pose_is_turns_with_it(buffer: Buffer) -> None:
    pose = in_laser(PoseWithCovarianceStamped)
    pose.pose.pose.orientation.w = 1.0
    spread = np.diag([1.0, 4.0, 9.0, 0.1, 0.2, 0.3])
    spread[0, 1] = spread[1, 0] = 0.5
    spread[0, 3] = spread[3, 0] = 0.7
    pose.pose.covariance = spread.ravel().tolist()
    found = np.reshape(buffer.transform(pose, "base").pose.covariance, (6, 6))
    # x of the laser is y of the base, and y of the laser is -x of the base.
    expected = np.diag([4.0, 1.0, 9.0, 0.2, 0.1, 0.3])
    expected[0, 1] = expected[1, 0] = -0.5
    expected[1, 4] = expected[4, 1] = 0.7
    assert found == pytest.approx(expected)


def test_a_wrench_is_turned_alone(buffer: Buffer) -> None:
    wrench = in_laser(WrenchStamped)
    wrench.wrench.force.x, wrench.wrench.torque.y = 1.0, 2.0
    found = buffer.transform(wrench, "base").wrench
    assert numbers(found.force) == pytest.approx((0.0, 1.0, 0.0))
    assert numbers(found.torque) == pytest.approx((-2.0, 0.0, 0.0))


def test_many_points_are_turned_and_shifted_at_once() -> None:
    for transform in (LASER, LASER.transform):
        found = sensor.transform_points([[3.0, 0.0, 0.0], [0.0, 1.0, 5.0]], transform)
        assert found == pytest.approx(np.array([[1.0, 3.0, 2.0], [0.0, 0.0, 7.0]]))


@pytest.mark.parametrize("order", ["<", ">"])
def test_a_cloud_is_turned_and_shifted_and_keeps_what_else_it_has(buffer: Buffer, order: str) -> None:
    kind = np.dtype([("label", "u1"), ("x", f"{order}f4"), ("y", f"{order}f8"), ("z", f"{order}f4")])
    offsets = {"label": 0, "x": 1, "y": 5, "z": 13}
    points = np.array([[(7, 3.0, 0.0, 0.0), (8, 0.0, 1.0, 5.0)]], kind)
    cloud = in_laser(PointCloud2)
    kinds = {"label": PointField.UINT8, "x": PointField.FLOAT32, "y": PointField.FLOAT64, "z": PointField.FLOAT32}
    cloud.fields = [PointField(name=n, offset=offsets[n], datatype=k, count=1) for n, k in kinds.items()]
    cloud.height, cloud.width, cloud.point_step, cloud.row_step = 1, 2, kind.itemsize, 2 * kind.itemsize
    cloud.is_bigendian, cloud.data = order == ">", points.tobytes()
    moved = buffer.transform(cloud, "base")
    found = np.frombuffer(bytes(moved.data), kind)
    assert found["label"].tolist() == [7, 8]
    assert np.stack([found[axis] for axis in "xyz"], axis=1) == pytest.approx(
        np.array([[1.0, 3.0, 2.0], [0.0, 0.0, 7.0]]), abs=1e-6
    )
    assert (moved.header.frame_id, cloud.header.frame_id) == ("base", "laser")
    cloud.fields = cloud.fields[:2]
    with pytest.raises(ValueError, match="x, y and z"):
        buffer.transform(cloud, "base")


def test_there_and_back_it_is_the_same(buffer: Buffer) -> None:
    point = in_laser(PointStamped)
    point.point = Point(x=0.3, y=-1.2, z=4.0)
    back = buffer.transform(buffer.transform(point, "base"), "laser")
    assert numbers(back.point) == pytest.approx(numbers(point.point))


def test_it_is_of_the_moment_of_its_stamp(buffer: Buffer) -> None:
    with pytest.raises(ExtrapolationException, match="only time 5"):
        buffer.transform(in_laser(PointStamped, 6.0), "base")
    with pytest.raises(ExtrapolationException):
        buffer.transform(in_laser(PointStamped, 6.0), "base", Duration(seconds=0.02))


def test_it_may_be_wanted_at_another_moment(buffer: Buffer) -> None:
    buffer.set_transform(at("base", "odom", 5.0), "test")
    buffer.set_transform(at("base", "odom", 6.0, x=1.0), "test")
    found = buffer.transform_full(in_laser(PointStamped), "base", Time(seconds=6), "odom")
    assert numbers(found.point) == pytest.approx((0.0, 0.0, 2.0))


def test_a_type_that_nobody_has_registered_is_named(buffer: Buffer) -> None:
    with pytest.raises(TypeException, match=r"Type <class '.*String'> is not loaded or supported"):
        buffer.transform(String(), "base")


def test_types_of_ones_own_are_registered_and_converted(buffer: Buffer) -> None:
    class Place:
        def __init__(self, x: float) -> None:
            self.x = x

    def moved(place: Place, transform: TransformStamped) -> Place:
        return Place(place.x + transform.transform.translation.x)

    def to_message(place: Place) -> PointStamped:
        return PointStamped(point=Point(x=place.x))

    registered.TransformRegistration().add(Place, moved)
    registered.ConvertRegistration().add_to_msg(Place, to_message)
    place = registered.Stamped(Place(2.0), Time(seconds=5).to_msg(), "laser")
    assert buffer.transform(place, "base").x == 3.0
    assert buffer.transform(place, "base", new_type=PointStamped).point.x == 3.0
    registered.ConvertRegistration().add_convert((Place, float), lambda one: one.x)
    assert registered.convert(place, float) == 2.0
    point = in_laser(PointStamped)
    assert registered.convert(point, PointStamped) == point
    assert registered.convert(point, PointStamped) is not point
    with pytest.raises(TypeException):
        registered.convert(place, String)


def test_an_interface_alone_finds_no_transforms() -> None:
    with pytest.raises(NotImplementedException, match="not implemented"):
        BufferInterface().lookup_transform("base", "laser", Time())
