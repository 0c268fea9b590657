"""Transforms objects of registered types."""

from course_kit.robots.tf.buffer_interface import BufferInterface
from course_kit.robots.tf.registration import (
    ConvertRegistration,
    NotImplementedException,
    Stamped,
    TransformRegistration,
    TypeException,
    convert,
)

__all__ = [
    "BufferInterface",
    "ConvertRegistration",
    "NotImplementedException",
    "Stamped",
    "TransformRegistration",
    "TypeException",
    "convert",
]
