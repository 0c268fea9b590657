"""The output of `ros2 bag info`, from data."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from operator import attrgetter
from typing import TYPE_CHECKING

from course_kit.lab.bags.selection import EVENTS, service_of

if TYPE_CHECKING:
    from course_kit.lab.bags.files import BagInfo, BagTopic

INDENT = " " * 19
UNITS = ("B", "KiB", "MiB", "GiB", "TiB")
SORTING = ("count", "name", "type")


def info_text(bag: BagInfo, sort: str = "name", sizes: Mapping[str, int] | None = None) -> str:
    """The block that `ros2 bag info` prints; with the size of each topic's messages if `sizes` are given."""
    topics, events = topics_and_events(bag, sort)
    shown = [_line(topic, sizes, "Topic", "") for topic in topics] or [""]
    lines = [
        "",
        f"Files:             {_column(bag.files)}",
        f"Bag size:          {size_text(bag.size)}",
        f"Storage id:        {bag.storage}",
        f"ROS Distro:        {bag.distro or 'unknown'}",
        f"Duration:          {seconds_text(bag.duration)}s",
        f"Start:             {moment_text(bag.start)}",
        f"End:               {moment_text(bag.end)}",
        f"Messages:          {bag.message_count - sum(t.count for t in events)}",
        f"Topic information: {_column(shown)}",
        f"Service:           {len(events)}",
        f"Service information: {_column([_line(t, sizes, 'Service', 'Event ') for t in events], INDENT + '  ')}",
    ]
    return "\n".join(lines) + ("\n" if events else "")


def topics_and_events(bag: BagInfo, sort: str) -> tuple[list[BagTopic], list[BagTopic]]:
    """The topics of a bag, sorted, and apart from them those that tell of service calls."""
    found: tuple[list[BagTopic], list[BagTopic]] = [], []
    for topic in sorted(bag.topics, key=attrgetter(sort)):
        found[service_of(topic.name, topic.type) is not None].append(topic)
    return found


def _column(lines: Sequence[str], indent: str = INDENT) -> str:
    return f"\n{indent}".join(lines)


def _line(topic: BagTopic, sizes: Mapping[str, int] | None, what: str, counted: str) -> str:
    name, kind = topic.name, topic.type
    if counted:
        name, kind = name.removesuffix(EVENTS), kind.removesuffix("_Event")
    size = f"Size Contribution: {size_text(sizes.get(topic.name, 0))} | " if sizes is not None else ""
    return (
        f"{what}: {name} | Type: {kind} | {counted}Count: {topic.count} | "
        f"{size}Serialization Format: {topic.serialization_format}"
    )


def size_text(size: float) -> str:
    """A number of bytes in the unit that fits: '8.1 KiB'."""
    unit = 0
    while size >= 1024 and unit < len(UNITS) - 1:
        size /= 1024
        unit += 1
    return f"{size:.{1 if unit else 0}f} {UNITS[unit]}"


def seconds_text(nanoseconds: int) -> str:
    """Seconds with all nine digits."""
    return f"{nanoseconds // 10**9}.{nanoseconds % 10**9:09}"


def moment_text(nanoseconds: int) -> str:
    """A time as date, time of day here, and seconds since the epoch."""
    local = time.localtime(nanoseconds // 10**9)
    moment = time.strftime("%b %e %Y %H:%M:%S", local)
    return f"{moment}.{nanoseconds % 10**9:09} ({seconds_text(nanoseconds)})"
