"""Tells where frames are now."""

from course_kit.tf.broadcasters import TransformBroadcaster

__all__ = ["TransformBroadcaster"]
