"""tf2_sensor_msgs: many points at once in another frame, as an array or as a PointCloud2."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from geometry_msgs.msg import Transform, TransformStamped
from sensor_msgs.msg import PointCloud2, PointField

from course_kit.robots.tf.conversions import placement
from course_kit.robots.tf.geometry import from_msg_msg, to_msg_msg
from course_kit.robots.tf.registration import ConvertRegistration, TransformRegistration
from course_kit.robots.tf.rigid_transforms import Floats

AXES = ("x", "y", "z")
FORMATS = {PointField.FLOAT32: "f4", PointField.FLOAT64: "f8"}


def transform_points(point_cloud: npt.ArrayLike, transform: Transform | TransformStamped) -> Floats:
    """Points in m, shape (points, 3), in the other frame."""
    where = placement(transform.transform if isinstance(transform, TransformStamped) else transform)
    return np.asarray(point_cloud, np.float64) @ where.rotation_matrix().T + where.translation


def do_transform_cloud(cloud: PointCloud2, transform: TransformStamped) -> PointCloud2:
    """A cloud in the other frame; what its points have beside x, y and z stays as it is."""
    data = np.frombuffer(bytes(cloud.data), np.uint8).copy()
    points = _coordinates(cloud, data)
    moved = transform_points(np.stack([points[axis].ravel() for axis in AXES], axis=1), transform)
    for axis, values in zip(AXES, moved.T, strict=True):
        points[axis] = values.reshape(points.shape)
    return PointCloud2(
        header=transform.header,
        height=cloud.height,
        width=cloud.width,
        fields=cloud.fields,
        is_bigendian=cloud.is_bigendian,
        point_step=cloud.point_step,
        row_step=cloud.row_step,
        data=data.tobytes(),
        is_dense=cloud.is_dense,
    )


def _coordinates(cloud: PointCloud2, data: npt.NDArray[np.uint8]) -> Any:
    """x, y and z of the points in `data`, which changes with them: a structured array, shape (height, width)."""
    fields = {field.name: field for field in cloud.fields if field.datatype in FORMATS}
    if not set(AXES) <= set(fields):
        raise ValueError(f"a cloud has x, y and z as float32 or float64; this one has {sorted(fields)}")
    order = ">" if cloud.is_bigendian else "<"
    kind = np.dtype(
        {
            "names": AXES,
            "formats": [order + FORMATS[fields[axis].datatype] for axis in AXES],
            "offsets": [fields[axis].offset for axis in AXES],
            "itemsize": cloud.point_step,
        }
    )
    return np.ndarray((cloud.height, cloud.width), kind, data, strides=(cloud.row_step, cloud.point_step))


TransformRegistration().add(PointCloud2, do_transform_cloud)
ConvertRegistration().add_to_msg(PointCloud2, to_msg_msg)
ConvertRegistration().add_from_msg(PointCloud2, from_msg_msg)
