"""Fills a buffer with what nodes tell."""

from course_kit.robots.tf.listener import TransformListener

__all__ = ["TransformListener"]
