"""Chapter 6's last exercise: a monitor, and how it is checked."""

from __future__ import annotations

import contextlib
import time
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from turtlesim.msg import Pose

from course_kit.examining.exercise import exercise
from course_kit.examining.station import Heard
from course_kit.examining.vocabulary import answer, expect, pause
from course_kit.examining.vocabulary_topics import (
    expect_compatible_subscription,
    expect_rate,
    expect_subscription,
    expect_topic,
    listen,
    publisher,
)

SCANS, POSES = "/scan", "/turtle1/pose"
LEVELS = {b"\x00": "OK", b"\x01": "WARN", b"\x02": "ERROR", b"\x03": "STALE"}


@exercise("debugging-7", "A monitor", points=5, minutes=40, level="project", timeout=40, node_class="Monitor")
def monitor() -> None:
    """It reports on two topics what comes of what should come."""
    laser, turtle = publisher(SCANS, LaserScan, qos_profile_sensor_data), publisher(POSES, Pose)
    answer()
    expect_subscription(SCANS, LaserScan)
    expect_subscription(POSES, Pose)
    expect_topic("/diagnostics", DiagnosticArray)
    expect_compatible_subscription(SCANS, laser)
    expect_compatible_subscription(POSES, turtle)
    heard = listen("/diagnostics", DiagnosticArray)
    pause(3.3)
    names = [status.name for status in _last(heard)]
    expect(
        "each report has a status for both topics",
        sorted(names) == [SCANS, POSES],
        f"The last report names {', '.join(names) or 'nothing'}: one DiagnosticStatus for each "
        f"topic, with the topic as its name.",
    )
    expect_rate(heard, 1.0, within=0.15)
    silent = _levels(heard)
    _drive(laser, turtle, every=1)
    full, rates = _levels(heard), _rates(heard)
    _drive(laser, turtle, every=3)
    fewer = _levels(heard)
    expect(
        "both are OK at 10 and at 62.5 Hz",
        full == {SCANS: "OK", POSES: "OK"},
        f"At full rates it said {full}: count what comes, look once a second, begin to count anew.",
    )
    expect(
        "it says WARN at a third of the rates, and STALE when nothing comes",
        fewer == {SCANS: "WARN", POSES: "WARN"} and silent == {SCANS: "STALE", POSES: "STALE"},
        f"At a third it said {fewer}, with nothing {silent}: below 80 % of what should come is WARN, nothing is STALE.",
    )
    expect(
        "`rate` has the rates that came",
        abs(rates.get(SCANS, 0.0) - 10.0) <= 2.5 and abs(rates.get(POSES, 0.0) - 62.5) <= 12.0,
        f"At 10 and 62.5 Hz it said {rates}: a KeyValue(key='rate', value=…), a number as text.",
    )


def _drive(laser: Any, turtle: Any, every: int) -> None:
    """Three seconds of poses at 62.5 Hz and scans at 10 Hz, or of one in `every` of them."""
    period, began = 0.016 * every, time.monotonic()
    scans = 0
    for tick in range(1, round(3.0 / period) + 1):
        turtle.publish(Pose())
        if tick * period * 10.0 / every > scans:
            laser.publish(LaserScan(ranges=[1.0]))
            scans += 1
        pause(max(0.0, began + tick * period - time.monotonic()))


def _levels(heard: Heard) -> dict[str, str]:
    return {status.name: LEVELS.get(bytes(status.level), "?") for status in _last(heard)}


def _rates(heard: Heard) -> dict[str, float]:
    rates = {}
    for status in _last(heard):
        for pair in status.values:
            if pair.key == "rate":
                with contextlib.suppress(ValueError, IndexError):
                    rates[status.name] = float(pair.value.split()[0])
    return rates


def _last(heard: Heard) -> list[Any]:
    return heard.last.status if len(heard) else []
