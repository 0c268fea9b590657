"""Fills a buffer with what nodes tell."""

from course_kit.tf.listener import TransformListener

__all__ = ["TransformListener"]
