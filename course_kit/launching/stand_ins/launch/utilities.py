"""Stands in for launch.utilities."""

from course_kit.launching.substitutions import normalize as normalize_to_list_of_substitutions
from course_kit.launching.substitutions import perform as perform_substitutions
from course_kit.launching.uncovered import attributes_of

__all__ = ["normalize_to_list_of_substitutions", "perform_substitutions"]
__getattr__ = attributes_of(__name__, __all__)
