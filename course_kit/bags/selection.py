"""Which topics of a graph are recorded, or of a bag played, by their names and types. Imports no ROS."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass


@dataclass(frozen=True)
class Selection:
    """Which topics to record or play: the names, types or regex given, or all; minus what is excluded."""

    names: Collection[str] = ()
    types: Collection[str] = ()
    regex: str = ""
    every: bool = False
    exclude_names: Collection[str] = ()
    exclude_types: Collection[str] = ()
    exclude_regex: str = ""
    with_hidden: bool = False
    with_unpublished: bool = False
    without_leaves: bool = False

    def takes(self, topic: str, type_name: str) -> bool:
        """Whether a topic is taken, as far as its name and type tell."""
        if topic in self.exclude_names or type_name in self.exclude_types:
            return False
        if self.exclude_regex and re.search(self.exclude_regex, topic):
            return False
        if self.every or topic in self.names or type_name in self.types:
            return True
        return bool(self.regex) and re.search(self.regex, topic) is not None

    @property
    def is_finite(self) -> bool:
        """Whether the names are all that is wanted, so that looking for topics has an end."""
        return bool(self.names) and not (self.every or self.types or self.regex)
