"""Frames, and where they have been: to be asked, and waited for."""

from course_kit.robots.tf.buffer import Buffer

__all__ = ["Buffer"]
