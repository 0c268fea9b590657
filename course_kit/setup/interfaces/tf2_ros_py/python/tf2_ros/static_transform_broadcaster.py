"""Tells where frames are for good."""

from course_kit.robots.tf.broadcasters import StaticTransformBroadcaster

__all__ = ["StaticTransformBroadcaster"]
