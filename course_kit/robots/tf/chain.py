"""The way from one frame to another. No ROS."""

from __future__ import annotations

from collections.abc import Callable


def chain_between(source: str, target: str, parent_of: Callable[[str], str | None]) -> list[str]:
    """The frames on the way from one frame to another, both included; empty if they are in different trees."""
    up = _ancestors(source, parent_of)
    down = _ancestors(target, parent_of)
    meeting = next((frame for frame in up if frame in down), None)
    if meeting is None:
        return []
    return up[: up.index(meeting) + 1] + down[: down.index(meeting)][::-1]


def _ancestors(frame: str, parent_of: Callable[[str], str | None]) -> list[str]:
    found = [frame]
    while (parent := parent_of(found[-1])) is not None and parent not in found:
        found.append(parent)
    return found
