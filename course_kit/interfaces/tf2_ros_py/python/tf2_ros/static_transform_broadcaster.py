"""Tells where frames are for good."""

from course_kit.tf.broadcasters import StaticTransformBroadcaster

__all__ = ["StaticTransformBroadcaster"]
