"""Stands in for launch.substitution."""

from course_kit.launching.substitutions import Substitution
from course_kit.launching.uncovered import attributes_of

__all__ = ["Substitution"]
__getattr__ = attributes_of(__name__, __all__)
