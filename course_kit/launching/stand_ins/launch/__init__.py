"""Stands in for the package `launch` of ROS 2, for the part that a course needs."""

from course_kit.launching.conditions import Condition
from course_kit.launching.context import LaunchContext
from course_kit.launching.entities import Action, LaunchDescription, LaunchDescriptionEntity
from course_kit.launching.events import Event
from course_kit.launching.handlers import EventHandler
from course_kit.launching.handlers import SomeEntities as SomeEntitiesType
from course_kit.launching.include import LaunchDescriptionSource
from course_kit.launching.service import LaunchService
from course_kit.launching.substitutions import SomeSubstitutions as SomeSubstitutionsType
from course_kit.launching.substitutions import Substitution
from course_kit.launching.uncovered import attributes_of

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
