"""Several bags as one: the topics of all, and their messages in the order of time, as if one had recorded them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from heapq import merge
from operator import itemgetter
from pathlib import Path
from typing import Any

from course_kit.lab.bags.files import OpenBag
from course_kit.lab.bags.storage import BagError


@dataclass(frozen=True)
class Together(OpenBag):
    """Open bags that are read as one."""

    bags: Sequence[OpenBag] = ()

    @property
    def end(self) -> int:
        """When the last message of all was received."""
        return max(bag.end for bag in self.bags)

    def messages(self, connections: Sequence[Any], start: int | None = None) -> Iterator[tuple[Any, int, bytes]]:
        """(connection, time of receipt, serialised message), in the order of time, from `start` on."""
        by_topic = {connection.topic: connection for connection in connections}

        def of(bag: OpenBag) -> Iterator[tuple[Any, int, bytes]]:
            own = [connection for connection in bag.connections if connection.topic in by_topic]
            for connection, nanoseconds, data in bag.messages(own, start):
                yield by_topic[connection.topic], nanoseconds, data

        return merge(*map(of, self.bags), key=itemgetter(1))


def together(bags: Sequence[OpenBag]) -> OpenBag:
    """Open bags as one. BagError if a topic has one type in one of them, and another in another."""
    if len(bags) == 1:
        return bags[0]
    topics: dict[str, Any] = {}
    for bag in bags:
        for connection in bag.connections:
            known = topics.setdefault(connection.topic, connection)
            if known.msgtype != connection.msgtype:
                types = f"{known.msgtype} and {connection.msgtype}"
                raise BagError(f"The bags cannot be played together: '{connection.topic}' is of two types, {types}")
            if known is not connection:
                profiles = [*known.ext.offered_qos_profiles, *connection.ext.offered_qos_profiles]
                topics[connection.topic] = known._replace(
                    msgcount=known.msgcount + connection.msgcount,
                    ext=known.ext._replace(offered_qos_profiles=profiles),
                )
    return Together(
        Path(" and ".join(bag.path.name for bag in bags)),
        list(topics.values()),
        min(bag.start for bag in bags),
        all(bag.is_complete for bag in bags),
        [],
        bags=bags,
    )
