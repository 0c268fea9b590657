"""The checks of `ros2 doctor`, from data: network, packages, platform, QoS and topics."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

# Topics that every node has, and that need no partner.
PARTNERLESS = frozenset({"/parameter_events", "/rosout"})
ERROR = "ERROR: "  # what a finding begins with by which its check has failed; others are warnings

# What the index says of the distribution that the course is for; it is not looked up, for that takes a network.
KNOWN: dict[str, dict[str, object]] = {
    "jazzy": {
        "distribution name": "jazzy",
        "distribution type": "ros2",
        "distribution status": "active",
        "release platforms": {"debian": ["bookworm"], "rhel": ["9"], "ubuntu": ["noble"]},
    }
}
RCLPY_VERSIONS = {"7.1": "jazzy"}  # what tells the distribution where ROS_DISTRO is not set: the wheels' versions


@dataclass(frozen=True)
class Topic:
    """A topic and how many publish it and subscribe to it."""

    name: str
    publishers: int
    subscribers: int


@dataclass(frozen=True)
class Pair:
    """A publisher and a subscription of one topic; `reason` says what does not fit, and is empty if all does."""

    topic: str
    type: str
    publisher: str
    subscriber: str
    reason: str = ""


@dataclass(frozen=True)
class System:
    """All that is looked at."""

    interfaces: Sequence[Mapping[str, Any]]  # the properties of each that are reported, by their names
    packages: Mapping[str, str]  # the version of each; empty if its package.xml has none
    distro: str
    middleware: str
    topics: Sequence[Topic]
    pairs: Sequence[Pair]


def network(system: System) -> Iterator[str]:
    """Return True if there is a loopback interface, another one, and one for multicast."""
    flags = [interface.get("flags", "").split(",") for interface in system.interfaces]
    if not any("LOOPBACK" in f for f in flags):
        yield f"{ERROR}No loopback IP address is found."
    if all("LOOPBACK" in f for f in flags):
        yield "Only loopback IP address is found."
    if not any("MULTICAST" in f for f in flags):
        yield "No multicast IP address is found."


def package(system: System) -> Iterator[str]:
    """Return True if packages are found, with their versions."""
    if not system.packages:
        yield f"{ERROR}local package info is not found."
    if names := " ".join(name for name, version in system.packages.items() if not version):
        shown = names if len(names) <= 100 else f"{names[:95].rsplit(' ', 1)[0]} [...]"
        yield f"Cannot find local versions of packages: {shown}. Use `ros2 doctor --report` to see full list."


def platform(system: System) -> Iterator[str]:
    """Return True if the distribution is known and supported."""
    if not system.distro:
        yield f"{ERROR}ROS_DISTRO is not set."
    elif system.distro not in KNOWN:
        yield f"{ERROR}Distribution name {system.distro} is not found"


def middleware(system: System) -> Iterator[str]:
    """Publishers and subscriptions whose QoS does not fit."""
    for pair in system.pairs:
        if pair.reason:
            kind, _, reason = pair.reason.partition(": ")
            prefix = ERROR if kind == "ERROR" else ""
            yield f"{prefix}QoS compatibility {kind.lower()} found on topic '{pair.topic}': {reason}"


def topic(system: System) -> Iterator[str]:
    """Topics that only publishers have, or only subscriptions."""
    for one in system.topics:
        if one.publishers and not one.subscribers:
            yield f"Publisher without subscriber detected on {one.name}."
        elif one.subscribers and not one.publishers:
            yield f"Subscriber without publisher detected on {one.name}."


CHECKS = {"network": network, "package": package, "platform": platform, "middleware": middleware, "topic": topic}


def failed(findings: Mapping[str, Sequence[str]], include_warnings: bool) -> list[str]:
    """The modules whose check has failed."""
    return [name for name, found in findings.items() if any(include_warnings or f.startswith(ERROR) for f in found)]


def summary(total: int, failed_modules: Sequence[str]) -> str:
    """The last words of the checks."""
    if not failed_modules:
        return f"\nAll {total} checks passed\n"
    return f"\n{len(failed_modules)}/{total} check(s) failed\n\nFailed modules: {' '.join(failed_modules)}"
