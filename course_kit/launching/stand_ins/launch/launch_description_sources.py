"""Stands in for launch.launch_description_sources."""

from course_kit.launching.include import AnyLaunchDescriptionSource, PythonLaunchDescriptionSource
from course_kit.launching.uncovered import attributes_of

__all__ = ["AnyLaunchDescriptionSource", "PythonLaunchDescriptionSource"]
__getattr__ = attributes_of(__name__, __all__)
