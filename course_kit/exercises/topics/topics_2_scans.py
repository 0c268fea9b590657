"""The check of topics-2: a subscription with the QoS of sensors."""

from __future__ import annotations

import math
import time
from functools import partial
from itertools import product
from operator import eq
from typing import Any

from rclpy.publisher import Publisher
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan

from course_kit.exercises.checker.assertions import answer, chance, expect, nobody_else, pause, read, wait_for_attribute
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.topic_assertions import (
    expect_compatible_subscription,
    expect_subscription,
    matches,
    publish_steadily,
    publisher,
)


@check_of("topics-2")
def sensor_qos() -> None:
    """It hears a laser that publishes with the sensors' QoS, and counts its scans."""
    nobody_else("rt/scan")
    laser = publisher("/scan", LaserScan, qos_profile_sensor_data)
    _a_counter()
    if not matches(laser):
        _a_counter()  # it may choose by the publishers that it knows, and by now it knows the laser
    expect_compatible_subscription("/scan", laser, points=1)
    sent, count = _two_bursts(laser)
    for slower in (2.0, 4.0):
        if not (isinstance(count, int | float) and 0.5 * sent <= count < sent):
            break
        _a_counter()  # best effort, or a depth of 1, may lose a scan on a busy machine, but not at each pace
        matches(laser)
        sent, count = _two_bursts(laser, slower)
    expect(
        "it counts the scans in `self.count`",
        count == sent,
        f"`self.count` is {count!r} after {sent} scans: begin with 0 and add 1 in the callback, for each message, "
        f"whatever is in it, and never begin anew.",
    )


def _a_counter() -> None:
    answer(threads=None)
    expect_subscription("/scan", LaserScan)


def _two_bursts(laser: Publisher, slower: float = 1.0) -> tuple[int, Any]:
    """How many scans were sent and counted, in all or to where the count was wrong; with a multiple of the period."""
    sent, count = 0, None
    for rest in (0.0, chance().uniform(2.2, 3.2)):
        pause(rest)
        scans = _a_burst()
        sent += len(scans)
        publish_steadily(laser, scans, period=slower * chance().uniform(0.02, 0.05))
        wait_for_attribute("count", partial(eq, sent), timeout=0.7)
        pause(chance().uniform(0.2, 0.4))
        count = read("count")  # none may be counted twice, or while none comes
        if count != sent:
            break
    return sent, count


def _a_burst() -> list[LaserScan]:
    """Scans of all lengths, also empty ones, with and without something in reach; one as when nothing moves."""
    kinds = [*product((0, 1, 3, 90, 360), (True, False))]
    kinds += chance().choices(kinds, k=chance().randint(0, 8))
    chance().shuffle(kinds)
    scans = [
        _stamped([chance().uniform(0.1, 8.0) if is_near else math.inf for _ in range(length)])
        for length, is_near in kinds
    ]
    place = chance().randrange(len(scans))
    scans[place:place] = [_stamped(scans[place].ranges) for _ in range(2)]
    return scans


def _stamped(ranges: Any) -> LaserScan:
    scan = LaserScan(ranges=ranges)
    scan.header.stamp.sec, scan.header.stamp.nanosec = divmod(time.time_ns(), 1_000_000_000)
    return scan
