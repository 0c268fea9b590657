"""Stands in for launch.some_substitutions_type."""

from course_kit.launching.substitutions import SomeSubstitutions as SomeSubstitutionsType
from course_kit.launching.uncovered import attributes_of

__all__ = ["SomeSubstitutionsType"]
__getattr__ = attributes_of(__name__, __all__)
