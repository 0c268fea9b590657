"""Which ends of a topic reach each other, and if not, why: the rules of DDS in the words of ROS."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

from course_kit.ros.graph.snapshot import Channel, Endpoint, Qos

# The names of both sides, sources first.
SIDES = {"topic": ("publisher", "subscription"), "service": ("client", "server"), "action": ("client", "server")}


@dataclass(frozen=True)
class Part:
    """Ends of a channel that reach each other, or ends of one side that reach nobody."""

    sources: tuple[Endpoint, ...]
    sinks: tuple[Endpoint, ...]

    @property
    def type(self) -> str:
        """The type of the part's endpoints."""
        return (self.sources + self.sinks)[0].type


def qos_reasons(offered: Qos, asked: Qos) -> list[str]:
    """Why a publisher's QoS is not enough for a subscription; empty if it is. As rclpy's qos_check_compatible()."""
    reasons = []
    if (offered.reliability, asked.reliability) == ("best_effort", "reliable"):
        reasons.append("reliable subscription, best-effort publisher")
    if (offered.durability, asked.durability) == ("volatile", "transient_local"):
        reasons.append("transient-local subscription, volatile publisher")
    if offered.deadline > asked.deadline:
        reasons.append(f"subscription asks for a deadline of {asked.deadline:g} s, {_promise(offered.deadline)}")
    if (offered.liveliness, asked.liveliness) == ("automatic", "manual_by_topic"):
        reasons.append("subscription asks for manual liveliness, publisher's is automatic")
    if offered.lease > asked.lease:
        reasons.append(f"subscription asks for a liveliness lease of {asked.lease:g} s, {_promise(offered.lease)}")
    return reasons


def _promise(seconds: float) -> str:
    return "publisher promises none" if seconds == float("inf") else f"publisher promises {seconds:g} s"


def mismatch(source: Endpoint, sink: Endpoint, kind: str = "topic") -> str | None:
    """Why a publisher and a subscription (or client and server) are not connected; None if they are."""
    if source.type != sink.type:
        return f"{source.type} and {sink.type} on one {kind}: nothing arrives"
    if kind == "topic" and (reasons := qos_reasons(source.qos, sink.qos)):
        return f"{', and '.join(reasons)}: nothing arrives"
    return None


def mismatches(channel: Channel) -> dict[tuple[Endpoint, Endpoint], str]:
    """Every source and sink of a channel that are not connected, with the reason."""
    pairs = itertools.product(channel.sources, channel.sinks)
    return {pair: reason for pair in pairs if (reason := mismatch(*pair, channel.kind)) is not None}


def parts(channel: Channel) -> list[Part]:
    """The channel taken apart: one part if everybody reaches somebody of everyone, those with both sides first.

    Ends that reach nobody form a part with those of their side and type.
    """
    ends = [(0, end) for end in channel.sources] + [(1, end) for end in channel.sinks]
    apart = mismatches(channel)
    group = list(range(len(ends)))  # the group of each end, named after one of its members

    def join(i: int, j: int) -> None:
        old, new = group[j], group[i]
        group[:] = [new if g == old else g for g in group]

    of_sources = len(channel.sources)
    for i, j in itertools.product(range(of_sources), range(of_sources, len(ends))):
        if (ends[i][1], ends[j][1]) not in apart:
            join(i, j)
    reached = {i for i in range(len(ends)) if group.count(group[i]) > 1}
    alone: dict[tuple[int, str], int] = {}
    for i, (side, end) in enumerate(ends):
        if i not in reached:
            join(alone.setdefault((side, end.type), i), i)
    members: dict[int, tuple[list[Endpoint], list[Endpoint]]] = {}
    for g, (side, end) in zip(group, ends, strict=True):
        members.setdefault(g, ([], []))[side].append(end)
    made = [Part(tuple(sources), tuple(sinks)) for sources, sinks in members.values()]
    return sorted(made, key=lambda part: (not (part.sources and part.sinks), not part.sources))


def explanations(channel: Channel, split: Sequence[Part] | None = None) -> list[str]:
    """One line for each reason in a channel; it names the nodes where the parts alone do not tell who is meant."""
    home = {
        (side, end): n
        for n, part in enumerate(parts(channel) if split is None else split)
        for side, ends in enumerate((part.sources, part.sinks))
        for end in ends
    }
    lines: dict[str, None] = {}
    for (source, sink), reason in mismatches(channel).items():
        within = home[(0, source)] == home[(1, sink)]
        lines[f"{source.node} to {sink.node}: {reason}" if within else reason] = None
    if not lines and len(channel.types) > 1:  # no pair, but still wrong
        lines[f"{' and '.join(channel.types)} on one {channel.kind}"] = None
    return list(lines)
