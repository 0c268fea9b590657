"""The interface that a form is for: a topic, a service or an action by name, with its type. Imports no ROS itself."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from course_kit.ros import interface_types
from course_kit.views.forms.fields import Field, message_field

TOPIC, SERVICE, ACTION = "topic", "service", "action"
_PARTS = {SERVICE: "Request", ACTION: "Goal"}


@dataclass(frozen=True)
class Interface:
    """A topic, service or action: what it is, its full name, the class of its type."""

    noun: str
    name: str
    type: Any

    @property
    def type_name(self) -> str:
        """Its type, such as 'std_msgs/msg/String'."""
        return interface_types.type_name(self.type)

    @property
    def part(self) -> str:
        """Which part of its class is filled in: Request, Goal, or empty for the class itself."""
        return _PARTS.get(self.noun, "")

    @cached_property
    def message_type(self) -> Any:
        """The class of what is filled in and sent."""
        return getattr(self.type, self.part) if self.part else self.type

    @cached_property
    def root(self) -> Field:
        """The fields that are filled in."""
        return message_field(self.message_type())
