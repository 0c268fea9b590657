"""Chapter 6's exercises in which a node is written: what each asks of it, and how it is checked."""

from __future__ import annotations

import contextlib
import time
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool, Float32
from turtlesim.msg import Pose

from course_kit.examining.exercise import exercise
from course_kit.examining.station import Heard
from course_kit.examining.vocabulary import answer, expect, pause, wait
from course_kit.examining.vocabulary_topics import (
    expect_compatible_subscription,
    expect_rate,
    expect_subscription,
    expect_topic,
    listen,
    publish_steadily,
    publisher,
    values,
)

SCANS, POSES = "/scan", "/turtle1/pose"
FEW = 5  # poses, fewer than any queue holds
LEVELS = {b"\x00": "OK", b"\x01": "WARN", b"\x02": "ERROR", b"\x03": "STALE"}


@exercise("debugging-3", "A watchdog", points=3, level="medium", timeout=20, node_class="Watchdog")
def watchdog() -> None:
    """It says five times a second whether a scan has come in the last half second."""
    laser = publisher(SCANS, LaserScan, qos_profile_sensor_data)
    answer()
    expect_subscription(SCANS, LaserScan)
    expect_topic("/scan_alive", Bool)
    alive = listen("/scan_alive", Bool)
    pause(1.5)
    said = values(alive, "data")
    expect(
        "without a scan it says false",
        said and not any(said),
        f"It said {said[-5:] or 'nothing'}. Nothing had come yet: begin with no time at all, or one long ago.",
    )
    expect_compatible_subscription(SCANS, laser)
    publish_steadily(laser, [LaserScan(ranges=[1.0])] * 20, period=0.1)
    with_scans = values(alive, "data")[-5:]
    began = time.time_ns()
    wait(lambda: _false_times(alive, began), 2.0)
    delay = next((when - began for when in _false_times(alive, began)), 0) * 1e-9
    expect(
        "it says true while scans come, and false half a second after the last",
        all(with_scans) and with_scans and 0.2 <= delay <= 1.1,
        f"While scans came, ten a second, it said {with_scans}, and false "
        f"{f'{delay:.1f} s after' if delay else 'not within 2 s of'} the last one: keep the time of each scan, and "
        f"compare it with the present time in the timer's callback, not in that of the scan.",
    )
    expect_rate(alive, 5.0, within=0.15)


def _false_times(heard: Heard, since: int) -> list[int]:
    return [when for when, message in heard.arrivals if when >= since and not message.data]


@exercise(
    "debugging-5", "A distance that survives a teleport", points=3, level="harder", timeout=20, node_class="Mileage"
)
def mileage() -> None:
    """It adds up what was driven, without what was jumped."""
    answer()
    expect_subscription(POSES, Pose)
    expect_topic("/mileage", Float32)
    turtle = publisher(POSES, Pose)
    expect_compatible_subscription(POSES, turtle)
    heard = listen("/mileage", Float32)
    wait(lambda: heard.publisher_count > 0, 3.0)
    driven = [Pose(x=1.0 + 0.03 * step, y=1.0 + 0.04 * step) for step in range(61)]  # 3 m
    _send(turtle, driven, heard)
    said = values(heard, "data")
    expect(
        "it publishes once for each pose, beginning with 0",
        len(said) == len(driven) and said[0] == 0.0,
        f"For {len(driven)} poses there were {len(said)} messages{f', the first {said[0]:.2f}' if said else ''}: "
        f"publish in the callback of the pose, also for the first one.",
        needed=not said,
    )
    expect(
        "60 steps of 0.05 m are 3 m",
        abs(said[-1] - 3.0) < 0.01,
        f"It said {said[-1]:.2f} m: add `math.dist` of one pose and the one before.",
    )
    after = [Pose(x=9.0, y=9.0 - 0.05 * step) for step in range(21)]  # a jump, then 1 m
    _send(turtle, after, heard)
    last = values(heard, "data")[-1]
    expect(
        "a teleport does not count, and what comes after it does",
        abs(last - 4.0) < 0.01,
        f"3 m, a jump, and 1 m more: it said {last:.2f} m. Leave out a step of more than 0.2 m, and go on from where "
        f"the turtle is then.",
    )


def _send(turtle: Any, poses: list[Pose], heard: Heard) -> None:
    """Publish poses a few at a time, the next when these were answered: so that a short queue loses none."""
    for first in range(0, len(poses), FEW):
        few = poses[first : first + FEW]
        answered = len(heard) + len(few)
        for pose in few:
            turtle.publish(pose)
        wait(lambda: len(heard) >= answered, 1.0)  # noqa: B023  (it ends before the loop goes on)


@exercise("debugging-7", "A monitor", points=5, level="project", timeout=40, node_class="Monitor")
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
