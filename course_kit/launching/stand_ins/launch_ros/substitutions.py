"""Stands in for launch_ros.substitutions."""

from course_kit.launching.package_substitutions import (
    ExecutableInPackage,
    FindPackage,
    FindPackagePrefix,
    FindPackageShare,
)
from course_kit.launching.uncovered import attributes_of

__all__ = ["ExecutableInPackage", "FindPackage", "FindPackagePrefix", "FindPackageShare"]
__getattr__ = attributes_of(__name__, __all__)
