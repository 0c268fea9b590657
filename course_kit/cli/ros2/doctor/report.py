"""The sections that `ros2 doctor --report` prints, from data."""

from __future__ import annotations

import platform
from collections.abc import Collection, Iterable, Iterator

from course_kit.cli.ros2.doctor.checks import KNOWN, System

LEAST_WIDTH = 8  # of the column of names; names as long as that get GAP more
GAP = 4
Item = tuple[str, object]  # name, value
OFFLINE = "latest versions are not looked up: that takes a network"


def sections(system: System, modules: Collection[str]) -> list[str]:
    """The sections that belong to the checks of some modules."""
    distribution = KNOWN.get(system.distro, {"distribution name": system.distro or "unknown"})
    everything: list[tuple[str, str, Iterable[Item]]] = [
        ("network", "NETWORK CONFIGURATION", (pair for one in system.interfaces for pair in one.items())),
        ("package", "PACKAGE VERSIONS", _packages(system)),
        ("platform", "PLATFORM INFORMATION", _platform()),
        ("middleware", "QOS COMPATIBILITY LIST", _qos(system)),
        ("middleware", "RMW MIDDLEWARE", [("middleware name", system.middleware)]),
        ("platform", "ROS 2 INFORMATION", distribution.items()),
        ("topic", "TOPIC LIST", _topics(system)),
    ]
    return [_section(title, list(items)) for module, title, items in everything if module in modules]


def _section(title: str, items: list[Item]) -> str:
    longest = max((len(name) for name, _ in items), default=0)
    width = LEAST_WIDTH if longest < LEAST_WIDTH else longest + GAP
    return "\n".join([f"\n   {title}", *(f"{name:{width}}: {value}" for name, value in items)])


def _packages(system: System) -> Iterator[Item]:
    for name, version in system.packages.items():
        yield name, f"latest=N/A, local={version}"
    yield "note", OFFLINE


def _platform() -> list[Item]:
    return [
        ("system", platform.system()),
        ("platform info", platform.platform()),
        ("release", platform.release()),
        ("processor", platform.processor()),
    ]


def _qos(system: System) -> Iterator[Item]:
    for pair in system.pairs:
        yield "topic [type]", f"{pair.topic} [{pair.type}]"
        yield "publisher node", pair.publisher
        yield "subscriber node", pair.subscriber
        yield "compatibility status", pair.reason or "OK"
    if not system.pairs:
        yield "compatibility status", "No publisher/subscriber pairs found"


def _topics(system: System) -> Iterator[Item]:
    for topic in system.topics:
        yield "topic", topic.name
        yield "publisher count", topic.publishers
        yield "subscriber count", topic.subscribers
    if not system.topics:
        yield from (("topic", "none"), ("publisher count", 0), ("subscriber count", 0))
