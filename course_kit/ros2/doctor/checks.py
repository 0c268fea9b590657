"""What `ros2 doctor` finds wrong, from data: network, packages, platform, QoS and topics."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

# Topics that every node has, and that need no partner.
PARTNERLESS = frozenset({"/parameter_events", "/rosout"})


@dataclass(frozen=True)
class Finding:
    """Something that is not as it should be; a check with an error has failed."""

    text: str
    is_error: bool = False

    def __str__(self) -> str:
        return f"UserWarning: {'ERROR: ' if self.is_error else ''}{self.text}"


@dataclass(frozen=True)
class Interface:
    """A network interface: its flags in lower case, and its other properties as they are reported."""

    name: str
    flags: str = ""
    mtu: int | None = None
    inet: tuple[str, ...] = ()
    inet6: tuple[str, ...] = ()
    ether: str | None = None
    netmask: str | None = None
    broadcast: str | None = None


@dataclass(frozen=True)
class Distribution:
    """A ROS 2 distribution as its index lists it."""

    name: str
    status: str
    platforms: Mapping[str, Sequence[str]]


# What the index says of the distribution that the course is for; it is not looked up, for that takes a network.
KNOWN = {"jazzy": Distribution("jazzy", "active", {"debian": ["bookworm"], "rhel": ["9"], "ubuntu": ["noble"]})}
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

    @property
    def is_error(self) -> bool:
        """Whether nothing can go from one to the other."""
        return self.reason.startswith("ERROR")


@dataclass(frozen=True)
class System:
    """All that is looked at."""

    interfaces: Sequence[Interface]
    packages: Mapping[str, str]  # the version of each; empty if its package.xml has none
    distro: str
    middleware: str
    topics: Sequence[Topic]
    pairs: Sequence[Pair]

    @property
    def distribution(self) -> Distribution | None:
        """What is known of the distribution."""
        return KNOWN.get(self.distro)


def network(system: System) -> list[Finding]:
    """Whether there is a loopback interface, another one, and one for multicast."""
    flags = [set(interface.flags.split(",")) for interface in system.interfaces]
    findings = []
    if not any("loopback" in f for f in flags):
        findings.append(Finding("No loopback IP address is found.", is_error=True))
    if all("loopback" in f for f in flags):
        findings.append(Finding("Only loopback IP address is found."))
    if not any("multicast" in f for f in flags):
        findings.append(Finding("No multicast IP address is found."))
    return findings


def package(system: System) -> list[Finding]:
    """Whether packages are found, with their versions."""
    if not system.packages:
        return [Finding("local package info is not found.", is_error=True)]
    without = [name for name, version in system.packages.items() if not version]
    if not without:
        return []
    names = " ".join(without)
    shortened = names if len(names) <= 100 else f"{names[:95].rsplit(' ', 1)[0]} [...]"
    return [
        Finding(f"Cannot find local versions of packages: {shortened}. Use `ros2 doctor --report` to see full list.")
    ]


def platform(system: System) -> list[Finding]:
    """Whether the distribution is known and supported."""
    if not system.distro:
        return [Finding("ROS_DISTRO is not set.", is_error=True)]
    if system.distribution is None:
        return [Finding(f"Distribution name {system.distro} is not found", is_error=True)]
    return []


def middleware(system: System) -> list[Finding]:
    """Publishers and subscriptions whose QoS does not fit."""
    findings = []
    for pair in system.pairs:
        if pair.reason:
            kind, _, reason = pair.reason.partition(": ")
            text = f"QoS compatibility {kind.lower()} found on topic '{pair.topic}': {reason}"
            findings.append(Finding(text, pair.is_error))
    return findings


def topic(system: System) -> list[Finding]:
    """Topics that only publishers have, or only subscriptions."""
    findings = []
    for one in system.topics:
        if one.publishers and not one.subscribers:
            findings.append(Finding(f"Publisher without subscriber detected on {one.name}."))
        elif one.subscribers and not one.publishers:
            findings.append(Finding(f"Subscriber without publisher detected on {one.name}."))
    return findings


CHECKS = {"network": network, "package": package, "platform": platform, "middleware": middleware, "topic": topic}


def failed(findings: Mapping[str, Sequence[Finding]], include_warnings: bool) -> list[str]:
    """The modules whose check has failed."""
    return [name for name, found in findings.items() if any(f.is_error or include_warnings for f in found)]


def summary(total: int, failed_modules: Sequence[str]) -> str:
    """The last words of the checks."""
    if not failed_modules:
        return f"\nAll {total} checks passed\n"
    return f"\n{len(failed_modules)}/{total} check(s) failed\n\nFailed modules: {' '.join(failed_modules)}"
