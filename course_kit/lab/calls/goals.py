"""Goals of an action as data, put together from what its server publishes about them.

An action server publishes the states of its goals on `<action>/_action/status` whenever one changes, and feedback on
`<action>/_action/feedback`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

# By action_msgs/msg/GoalStatus.
STATES = ("UNKNOWN", "ACCEPTED", "EXECUTING", "CANCELING", "SUCCEEDED", "CANCELED", "ABORTED")
ENDS = ("SUCCEEDED", "CANCELED", "ABORTED")


@dataclass
class Goal:
    """A goal: when it came into which state, and when feedback on it was published, in seconds; its id."""

    changes: list[tuple[float, str]] = field(default_factory=list)
    feedback: list[float] = field(default_factory=list)
    uuid: bytes = b""

    @property
    def accepted(self) -> float:
        """When it was accepted, or first seen."""
        return self.changes[0][0]

    @property
    def state(self) -> str:
        """The last state known."""
        return self.changes[-1][1]

    @property
    def ended(self) -> float | None:
        """When it succeeded, was cancelled or aborted; None if it goes on."""
        return self.changes[-1][0] if self.state in ENDS else None


def goals_of(statuses: Iterable[tuple[float, Any]], feedback: Iterable[tuple[float, Any]] = ()) -> list[Goal]:
    """The goals in (time, message) pairs of an action's status and feedback topics, in the order of their acceptance.

    Goals that had ended before the first message are left out: a server goes on naming them for 15 minutes.
    """
    found: dict[bytes, Goal] = {}
    over: set[bytes] = set()
    for time, message in statuses:
        for status in message.status_list:
            key, state = bytes(bytearray(status.goal_info.goal_id.uuid)), STATES[status.status]
            if key not in found and (state in ENDS or key in over):
                over.add(key)
                continue
            changes = found.setdefault(key, Goal(uuid=key)).changes
            if not changes or changes[-1][1] != state:
                changes.append((time, state))
    for time, message in feedback:
        goal = found.get(bytes(bytearray(message.goal_id.uuid)))
        if goal is not None:
            goal.feedback.append(time)
    return sorted(found.values(), key=lambda goal: goal.accepted)
