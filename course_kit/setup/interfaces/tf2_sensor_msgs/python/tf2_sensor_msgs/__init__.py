"""Clouds of points in other frames; importing it registers PointCloud2. The course's; robots/tf does the work."""

from course_kit.robots.tf.clouds import do_transform_cloud, transform_points
from course_kit.robots.tf.geometry import from_msg_msg, to_msg_msg

__all__ = ["do_transform_cloud", "from_msg_msg", "to_msg_msg", "transform_points"]
