"""Stands in for the package `launch` of ROS 2, for the part that a course needs."""

from course_kit.ros2.launching.conditions import Condition
from course_kit.ros2.launching.context import LaunchContext
from course_kit.ros2.launching.entities import Action, LaunchDescription, LaunchDescriptionEntity
from course_kit.ros2.launching.events import Event
from course_kit.ros2.launching.handlers import EventHandler
from course_kit.ros2.launching.handlers import SomeEntities as SomeEntitiesType
from course_kit.ros2.launching.include import LaunchDescriptionSource
from course_kit.ros2.launching.service import LaunchService
from course_kit.ros2.launching.substitutions import SomeSubstitutions as SomeSubstitutionsType
from course_kit.ros2.launching.substitutions import Substitution
from course_kit.ros2.launching.uncovered import attributes_of

__all__ = [
    "Action",
    "Condition",
    "Event",
    "EventHandler",
    "LaunchContext",
    "LaunchDescription",
    "LaunchDescriptionEntity",
    "LaunchDescriptionSource",
    "LaunchService",
    "SomeEntitiesType",
    "SomeSubstitutionsType",
    "Substitution",
]
__getattr__ = attributes_of(__name__, __all__)
