"""Stands in for launch.utilities."""

from course_kit.ros2.launching.substitutions import (
    normalize as normalize_to_list_of_substitutions,
)
from course_kit.ros2.launching.substitutions import (
    perform as perform_substitutions,
)
from course_kit.ros2.launching.uncovered import attributes_of

__all__ = ["normalize_to_list_of_substitutions", "perform_substitutions"]
__getattr__ = attributes_of(__name__, __all__)
