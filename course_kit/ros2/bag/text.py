"""What `ros2 bag` prints, from data: the block of `info`, and log lines."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from course_kit.bags.files import BagInfo, BagTopic
    from course_kit.bags.recorder import BagLogLine

INDENT = " " * 19
UNITS = ("B", "KiB", "MiB", "GiB", "TiB")
EVENT_TOPIC = "/_service_event"
SORTING: Mapping[str, Callable[[BagTopic], Any]] = {
    "name": lambda topic: topic.name,
    "type": lambda topic: topic.type,
    "count": lambda topic: topic.count,
}


def log_text(line: BagLogLine) -> str:
    """A line as rcl's console shows it."""
    seconds, nanoseconds = divmod(line.stamp, 10**9)
    return f"[{line.level}] [{seconds}.{nanoseconds:09}] [{line.logger}]: {line.text}"


def info_text(bag: BagInfo, sort: str = "name", sizes: Mapping[str, int] | None = None) -> str:
    """The block that `ros2 bag info` prints; with the size of each topic's messages if `sizes` are given."""
    topics = sorted((t for t in bag.topics if not _is_service_event(t)), key=SORTING[sort])
    events = sorted((t for t in bag.topics if _is_service_event(t)), key=SORTING[sort])
    shown = [_topic_line(topic, sizes) for topic in topics] or [""]
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
        f"Service information: {_column([_event_line(topic, sizes) for topic in events], INDENT + '  ')}",
    ]
    return "\n".join(lines) + ("\n" if events else "")


def _column(lines: Sequence[str], indent: str = INDENT) -> str:
    return f"\n{indent}".join(lines)


def _topic_line(topic: BagTopic, sizes: Mapping[str, int] | None) -> str:
    size = f"Size Contribution: {size_text(sizes.get(topic.name, 0))} | " if sizes is not None else ""
    return (
        f"Topic: {topic.name} | Type: {topic.type} | Count: {topic.count} | "
        f"{size}Serialization Format: {topic.serialization_format}"
    )


def _event_line(topic: BagTopic, sizes: Mapping[str, int] | None) -> str:
    size = f"Size Contribution: {size_text(sizes.get(topic.name, 0))} | " if sizes is not None else ""
    return (
        f"Service: {topic.name.removesuffix(EVENT_TOPIC)} | Type: {topic.type.removesuffix('_Event')} | "
        f"Event Count: {topic.count} | {size}Serialization Format: {topic.serialization_format}"
    )


def topic_names(bag: BagInfo, sort: str = "name") -> list[str]:
    """The topics of a bag, without those that tell of service calls."""
    return [t.name for t in sorted(bag.topics, key=SORTING[sort]) if not _is_service_event(t)]


def _is_service_event(topic: BagTopic) -> bool:
    return topic.name.endswith(EVENT_TOPIC) and "/srv/" in topic.type and topic.type.endswith("_Event")


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
    date = f"{time.strftime('%b', local)} {local.tm_mday:2} {local.tm_year}"
    return f"{date} {time.strftime('%H:%M:%S', local)}.{nanoseconds % 10**9:09} ({seconds_text(nanoseconds)})"
