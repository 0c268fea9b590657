"""Which topics of a graph are recorded, or of a bag played, by their names and types. Imports no ROS."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass

EVENTS = "/_service_event"  # what the topic of a service's events adds to its name


def service_of(topic: str, type_name: str) -> str | None:
    """The service of whose calls a topic tells; None for any other topic."""
    is_one = topic.endswith(EVENTS) and "/srv/" in type_name and type_name.endswith("_Event")
    return topic.removesuffix(EVENTS) if is_one else None


@dataclass(frozen=True)
class Selection:
    """Which topics to record or play: the names, types or regex given, or all; minus what is excluded.

    Of services it is the topics that tell of their calls, which have the types of events.
    """

    names: Collection[str] = ()
    types: Collection[str] = ()
    regex: str = ""
    every: bool = False
    services: Collection[str] = ()
    every_service: bool = False
    exclude_names: Collection[str] = ()
    exclude_types: Collection[str] = ()
    exclude_services: Collection[str] = ()
    exclude_regex: str = ""
    with_hidden: bool = False
    with_unpublished: bool = False
    without_leaves: bool = False

    def takes(self, topic: str, type_name: str) -> bool:
        """Return True if a topic is taken, as far as its name and type tell."""
        if (service := service_of(topic, type_name)) is not None and (found := self._of_service(service)) is not None:
            return found
        if topic in self.exclude_names or type_name in self.exclude_types:
            return False
        if self.exclude_regex and re.search(self.exclude_regex, topic):
            return False
        if self.every or topic in self.names or type_name in self.types:
            return True
        return bool(self.regex) and re.search(self.regex, topic) is not None

    def takes_service(self, service: str) -> bool:
        """Return True if the calls of a service are taken, though the topic that tells of them is hidden."""
        return bool(self._of_service(service))

    def _of_service(self, service: str) -> bool | None:
        """Return True if the calls of a service are taken, None if only its topic can tell."""
        if service in self.exclude_services or (self.exclude_regex and re.search(self.exclude_regex, service)):
            return False
        if self.every_service or service in self.services or (self.regex and re.search(self.regex, service)):
            return True
        return None

    @property
    def wanted(self) -> set[str]:
        """The topics that are named."""
        return {*self.names, *(service + EVENTS for service in self.services)}

    @property
    def is_finite(self) -> bool:
        """True if the names are all that is wanted, so that looking for topics has an end."""
        return bool(self.wanted) and not (self.every or self.every_service or self.types or self.regex)
