"""Looks at the lab's robot from outside: the messages of its topics over two seconds, and their rates.

A Watch listens, through a DomainObserver; findings() judges, and is pure. examine() does both until all is well: for
the lab in the notebook's process, and for expect_well() (debugging/robot_well.py) in the checker's.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from course_kit.exercises.protocol.verdict import Finding
from course_kit.robots.turtlesim.paths import length
from course_kit.ros.graph import graph
from course_kit.ros.observing.domain_observer import DomainObserver
from course_kit.ros.observing.received_messages import ReceivedMessages
from course_kit.ros.subscriptions.topics import message_class

Wait = Callable[[Callable[[], bool], float], object]  # wait(condition, timeout): until it holds or the time is over

WINDOW = 2.0  # seconds
RATE = 10.0  # Hz, of scans and of commands
WITHIN = 0.25  # parts of the rate: two seconds on a busy machine
DISTANCE = 0.5  # metres that a driving turtle makes at least in that time
LOG_LINES = 40  # in that time
TOPICS = {
    "/scan": "sensor_msgs/msg/LaserScan",
    "/turtle1/cmd_vel": "geometry_msgs/msg/Twist",
    "/turtle1/pose": "turtlesim/msg/Pose",
    "/map_scans": "std_msgs/msg/Int32",
    "/rosout": "rcl_interfaces/msg/Log",
}


@dataclass(frozen=True)
class Observation:
    """What came in the last WINDOW seconds."""

    scans: float  # Hz
    commands: float  # Hz
    distance: float  # metres that the turtle has gone
    scans_in_map: float  # Hz
    log_lines: int
    twice: tuple[str, ...] = ()  # names that more than one node has


def findings(seen: Observation) -> list[Finding]:
    """What is well and what is not, in the order of the data's way through the robot."""

    def has_rate(measured: float) -> bool:
        return abs(measured - RATE) <= WITHIN * RATE

    return [
        Finding(f"`/scan` has {RATE:g} scans a second", has_rate(seen.scans), f"There were {seen.scans:.1f} a second."),
        Finding(
            "nearly every scan gets into the map",
            seen.scans_in_map >= (1 - WITHIN) * RATE,
            f"`/map_scans` grew by {seen.scans_in_map:.1f} a second.",
        ),
        Finding(
            f"`/turtle1/cmd_vel` has {RATE:g} commands a second",
            has_rate(seen.commands),
            f"There were {seen.commands:.1f} a second.",
        ),
        Finding("the turtle drives", seen.distance >= DISTANCE, f"It went {seen.distance:.2f} m in {WINDOW:g} s."),
        Finding(
            "the nodes log little",
            seen.log_lines <= LOG_LINES,
            f"`/rosout` had {seen.log_lines / WINDOW:.0f} lines a second.",
        ),
        Finding(
            "no two nodes have the same name",
            not seen.twice,
            f"More than one is called {', '.join(seen.twice)}: one of them was left running.",
        ),
    ]


class Watch:
    """Listens to the robot's topics through a DomainObserver, from now on."""

    def __init__(self, observer: DomainObserver) -> None:
        self._observer = observer
        self._began = time.monotonic()
        self._heard = {topic: observer.listen(topic, message_class(kind)) for topic, kind in TOPICS.items()}

    @property
    def seconds(self) -> float:
        """How long it has listened."""
        return time.monotonic() - self._began

    def observe(self) -> Observation:
        """What came in the last WINDOW seconds; all of them must have passed since the watch began."""
        since = time.time_ns() - int(WINDOW * 1e9)
        count = {topic: sum(when >= since for when in heard.times) for topic, heard in self._heard.items()}
        return Observation(
            scans=count["/scan"] / WINDOW,
            commands=count["/turtle1/cmd_vel"] / WINDOW,
            distance=length(_newest(self._heard["/turtle1/pose"], since)),
            scans_in_map=_growth([message.data for message in _newest(self._heard["/map_scans"], since)]),
            log_lines=count["/rosout"],
            twice=tuple(graph.duplicates(graph.nodes(self._observer.node))),
        )


def examine(observer: DomainObserver, timeout: float, wait: Wait) -> list[Finding]:
    """What is found in the robot, once all is well or the time is over; of the last WINDOW seconds, never of less."""
    watch = Watch(observer)
    seen: list[Finding] = []

    def is_well() -> bool:
        seen[:] = findings(watch.observe())
        return all(finding.ok for finding in seen)

    wait(lambda: watch.seconds >= WINDOW, WINDOW + 1.0)
    wait(is_well, max(0.0, timeout - watch.seconds))
    return seen


def _newest(heard: ReceivedMessages, since: int) -> list[Any]:
    return [message for when, message in heard.arrivals if when >= since]


def _growth(counts: Sequence[int]) -> float:
    """Scans a second: n messages within the time stand for n periods, and have n - 1 steps between them."""
    if len(counts) < 2:
        return 0.0
    return (counts[-1] - counts[0]) / (len(counts) - 1) * len(counts) / WINDOW
