"""Tells where frames are now."""

from course_kit.robots.tf.broadcasters import TransformBroadcaster

__all__ = ["TransformBroadcaster"]
