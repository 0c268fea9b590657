"""The sections that `ros2 doctor --report` prints, from data."""

from __future__ import annotations

import platform
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

from course_kit.ros2.doctor.checks import KNOWN, System

LEAST_WIDTH = 8  # of the column of names; names as long as that get GAP more
GAP = 4
OFFLINE = "latest versions are not looked up: that takes a network"


@dataclass(frozen=True)
class Section:
    """A part of the report; `module` is the check that it belongs to."""

    module: str
    title: str
    items: Sequence[tuple[str, object]]

    def __str__(self) -> str:
        longest = max((len(name) for name, _ in self.items), default=0)
        width = LEAST_WIDTH if longest < LEAST_WIDTH else longest + GAP
        return "\n".join([f"\n   {self.title}", *(f"{name:{width}}: {value}" for name, value in self.items)])


def sections(system: System, modules: Collection[str]) -> list[Section]:
    """The sections of some modules."""
    distribution = KNOWN.get(system.distro, {"distribution name": system.distro or "unknown"})
    everything = [
        Section("network", "NETWORK CONFIGURATION", [pair for one in system.interfaces for pair in one.items()]),
        Section("package", "PACKAGE VERSIONS", list(_packages(system))),
        Section("platform", "PLATFORM INFORMATION", _platform()),
        Section("middleware", "QOS COMPATIBILITY LIST", list(_qos(system))),
        Section("middleware", "RMW MIDDLEWARE", [("middleware name", system.middleware)]),
        Section("platform", "ROS 2 INFORMATION", list(distribution.items())),
        Section("topic", "TOPIC LIST", list(_topics(system))),
    ]
    return [section for section in everything if section.module in modules]


def _packages(system: System) -> Iterator[tuple[str, object]]:
    for name, version in system.packages.items():
        yield name, f"latest=N/A, local={version}"
    yield "note", OFFLINE


def _platform() -> list[tuple[str, object]]:
    return [
        ("system", platform.system()),
        ("platform info", platform.platform()),
        ("release", platform.release()),
        ("processor", platform.processor()),
    ]


def _qos(system: System) -> Iterator[tuple[str, object]]:
    for pair in system.pairs:
        yield "topic [type]", f"{pair.topic} [{pair.type}]"
        yield "publisher node", pair.publisher
        yield "subscriber node", pair.subscriber
        yield "compatibility status", pair.reason or "OK"
    if not system.pairs:
        yield "compatibility status", "No publisher/subscriber pairs found"


def _topics(system: System) -> Iterator[tuple[str, object]]:
    for topic in system.topics:
        yield "topic", topic.name
        yield "publisher count", topic.publishers
        yield "subscriber count", topic.subscribers
    if not system.topics:
        yield from (("topic", "none"), ("publisher count", 0), ("subscriber count", 0))
