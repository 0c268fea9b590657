"""tf2_geometry_msgs: messages of geometry_msgs in another frame.

Each do_transform function takes a message and where its frame is in the other one, as lookup_transform() gives it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from geometry_msgs.msg import (
    PointStamped,
    Pose,
    PoseStamped,
    PoseWithCovarianceStamped,
    TransformStamped,
    Vector3Stamped,
    Wrench,
    WrenchStamped,
)

from course_kit.robots.tf.conversions import placement, put, quaternion, quaternion_message, vector
from course_kit.robots.tf.registration import ConvertRegistration, TransformRegistration
from course_kit.robots.tf.rigid_transforms import RigidTransform


def to_msg_msg(msg: Any) -> Any:
    """A message as a message: itself."""
    return msg


def from_msg_msg(msg: Any) -> Any:
    """A message from a message: itself."""
    return msg


def transform_covariance(cov_in: Sequence[float], transform: TransformStamped) -> list[float]:
    """A covariance of x, y, z and the turns about them, 36 numbers row by row, as the other frame sees it."""
    both = np.kron(np.eye(2), placement(transform.transform).rotation_matrix())
    return list(map(float, (both @ np.asarray(cov_in, np.float64).reshape(6, 6) @ both.T).ravel()))


def do_transform_point(point: PointStamped, transform: TransformStamped) -> PointStamped:
    """A point in the other frame."""
    result = PointStamped(header=transform.header)
    put(result.point, placement(transform.transform).at(vector(point.point)))
    return result


def do_transform_vector3(vector3: Vector3Stamped, transform: TransformStamped) -> Vector3Stamped:
    """A vector as the other frame sees it: turned, not shifted."""
    result = Vector3Stamped(header=transform.header)
    put(result.vector, placement(transform.transform).turned(vector(vector3.vector)))
    return result


def do_transform_pose(pose: Pose, transform: TransformStamped) -> Pose:
    """A pose without a header in the other frame."""
    inside = RigidTransform(vector(pose.position), quaternion(pose.orientation))
    outside = placement(transform.transform) @ inside
    result = Pose(orientation=quaternion_message(outside.rotation))
    put(result.position, outside.translation)
    return result


def do_transform_pose_stamped(pose: PoseStamped, transform: TransformStamped) -> PoseStamped:
    """A pose in the other frame."""
    return PoseStamped(header=transform.header, pose=do_transform_pose(pose.pose, transform))


def do_transform_pose_with_covariance_stamped(
    pose: PoseWithCovarianceStamped, transform: TransformStamped
) -> PoseWithCovarianceStamped:
    """A pose in the other frame, and how sure it is there."""
    result = PoseWithCovarianceStamped(header=transform.header)
    result.pose.pose = do_transform_pose(pose.pose.pose, transform)
    result.pose.covariance = transform_covariance(pose.pose.covariance, transform)
    return result


def do_transform_wrench(wrench: Wrench, transform: TransformStamped) -> Wrench:
    """A force and a torque as the other frame sees them."""
    where = placement(transform.transform)
    result = Wrench()
    put(result.force, where.turned(vector(wrench.force)))
    put(result.torque, where.turned(vector(wrench.torque)))
    return result


def do_transform_wrench_stamped(wrench: WrenchStamped, transform: TransformStamped) -> WrenchStamped:
    """The same with a header."""
    return WrenchStamped(header=transform.header, wrench=do_transform_wrench(wrench.wrench, transform))


TRANSFORMS = {
    PointStamped: do_transform_point,
    Vector3Stamped: do_transform_vector3,
    PoseStamped: do_transform_pose_stamped,
    PoseWithCovarianceStamped: do_transform_pose_with_covariance_stamped,
    WrenchStamped: do_transform_wrench_stamped,
}
for _kind, _transform in TRANSFORMS.items():
    TransformRegistration().add(_kind, _transform)
    ConvertRegistration().add_to_msg(_kind, to_msg_msg)
    ConvertRegistration().add_from_msg(_kind, from_msg_msg)
