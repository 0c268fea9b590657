"""The callbacks of a node by groups, and how many may run at the same time. Pure: no ROS."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Callback:
    """What makes a callback due, such as `timer` and `every 0.2 s`, and the function that is called, if any."""

    kind: str
    cause: str
    function: str


@dataclass(frozen=True)
class Group:
    """A callback group with the callbacks that the node's author has put into it; `others` are rclpy's own."""

    is_reentrant: bool
    is_default: bool
    callbacks: tuple[Callback, ...]
    others: int = 0

    @property
    def title(self) -> str:
        """What it is and whose."""
        kind = "reentrant group" if self.is_reentrant else "mutually exclusive group"
        return f"{kind}, {'the default of the node' if self.is_default else 'made by the node'}"

    @property
    def rule(self) -> str:
        """What may run of it at the same time."""
        return "any number at a time" if self.is_reentrant else "one at a time"


@dataclass(frozen=True)
class Execution:
    """A node, the executor that spins it, and the node's groups; no executor has no threads."""

    node: str
    executor: str
    threads: int
    groups: tuple[Group, ...]

    @property
    def at_once(self) -> str:
        """How many callbacks may run at the same time, and why, in a sentence."""
        if not self.threads:
            return "No executor spins this node: none of its callbacks runs."
        if self.threads == 1:
            return "One thread: one callback at a time, whatever their groups."
        if any(group.is_reentrant for group in self.groups):
            return f"{self.threads} threads and a reentrant group: up to {self.threads} callbacks at a time."
        if len(self.groups) <= 1:
            return f"{self.threads} threads, but one mutually exclusive group: one callback at a time."
        groups = len(self.groups)
        most = min(self.threads, groups)
        return f"{self.threads} threads and {groups} groups: up to {most} callbacks at a time, one of each group."
