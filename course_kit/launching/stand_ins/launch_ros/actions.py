"""Stands in for launch_ros.actions."""

from course_kit.launching.node import Node, PushROSNamespace, SetParameter, SetRemap
from course_kit.launching.node import PushROSNamespace as PushRosNamespace
from course_kit.launching.uncovered import attributes_of

__all__ = ["Node", "PushROSNamespace", "PushRosNamespace", "SetParameter", "SetRemap"]
__getattr__ = attributes_of(__name__, __all__)
