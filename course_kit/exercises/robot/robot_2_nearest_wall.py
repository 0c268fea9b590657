"""The check of robot-2: the nearest wall of each scan, in a frame that stays."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from geometry_msgs.msg import PointStamped
from sensor_msgs.msg import LaserScan

from course_kit.exercises.checker.assertions import answer, chance, expect, raised, wait
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.late_scans import LASER, REMAPPED, LateScans
from course_kit.exercises.checker.robot_fixtures import (
    PACED,
    Pace,
    a_robot,
    hear_robot,
    hear_tf,
    place_in,
    seconds_of,
    wait_simulated,
)
from course_kit.exercises.checker.topic_assertions import expect_compatible_subscription, expect_topic, listen
from course_kit.robots.navigation.places import after

Point = tuple[float, float]
EXACT = 0.02  # m, of a point whose stamp is that of a scan
OLDEST = 0.3  # s after its stamp at which a scan comes at the latest
SILENT = 0.7  # s from point to point: more than a scan that comes late, and whose point comes with the next one
TURN = 9.0  # simulated s for which the robot turns
ENOUGH = 0.8  # of the scans, for who is late on a busy machine


class Spoiler:
    """Hides what is nearest in every other scan among ranges that are no hits."""

    def __init__(self) -> None:
        self.spoilt: set[float] = set()  # the stamps of those scans, s
        self._count = 0

    def __call__(self, scan: LaserScan) -> None:
        """Change the scan, or leave it as it is."""
        self._count += 1
        if self._count % 2:
            return
        bad = (math.nan, -math.inf, 0.0, scan.range_min / 2, 4 * scan.range_max, math.inf)
        for number, value in zip(chance().sample(range(len(scan.ranges)), len(bad)), bad, strict=True):
            scan.ranges[number] = value
        self.spoilt.add(seconds_of(scan.header.stamp))


@check_of("robot-2")
def nearest_wall() -> None:
    """Where the nearest hit of each scan is in odom, at the scan's stamp, though the scan comes late."""
    robot = a_robot("rooms", seed=chance().randrange(1000), patience=PACED, remap=REMAPPED)
    wait_simulated(robot, 1.5, timeout=15.0)
    answer(use_sim_time=True)
    expect_topic("/nearest_wall", PointStamped)
    transforms, points = hear_tf(), listen("/nearest_wall", PointStamped)
    spoiler = Spoiler()
    scans = LateScans(robot, 0.1, OLDEST, spoiler)
    expect_compatible_subscription("/scan", scans.out)
    old = hear_robot(LASER, LaserScan).last
    old.header.stamp.sec, old.header.stamp.nanosec = 0, 200_000_000  # older than all that the answer may have heard
    scans.out.publish(old)
    wait_simulated(robot, 0.5, timeout=10.0)
    turning = chance().choice((1, -1)) * chance().uniform(0.9, 1.4)
    begun, pace = robot.simulation.time, Pace(robot, points, SILENT)

    def is_over() -> bool:
        pace.command(0.0, turning)
        scans.pass_on()
        return bool(robot.simulation.time > begun + TURN)

    wait(is_over, 40.0, "the robot to turn")
    robot.vehicle.command(0.0, 0.0, robot.simulation.time)
    wait(lambda: len(points) >= len(scans.sent), 3.0)
    sent = [(scan, seconds_of(scan.header.stamp) in spoiler.spoilt) for scan in scans.sent]
    _judge_walls(sent, {seconds_of(one.header.stamp): one for one in points.messages}, transforms.buffer())


def _judge_walls(sent: list[tuple[LaserScan, bool]], told: dict[float, Any], buffer: Any) -> None:
    stamped = [(scan, spoilt, told[seconds_of(scan.header.stamp)]) for scan, spoilt in sent if _has(told, scan)]
    errors = raised()
    frames = {one.header.frame_id for _, _, one in stamped}
    expect(
        "each scan has its point in `odom`, with its stamp, and the node lives on",
        len(stamped) >= ENOUGH * len(sent) and frames == {"odom"} and not errors,
        f"Of {len(sent)} scans {len(stamped)} have a point with their stamp, and {len(told)} points came, with the "
        f"frame {', '.join(sorted(map(repr, frames))) or 'of none'}. The point's header is that of the scan, but for "
        "the frame. `lookup_transform` raises a TransformException for a moment that tf2 does not know: catch it, and "
        "leave that scan out.",
        needed=len(stamped) < 0.3 * len(sent) or frames != {"odom"},
    )
    clean = [(scan, one) for scan, spoilt, one in stamped if not spoilt]
    spoilt_ones = [(scan, one) for scan, spoilt, one in stamped if spoilt]
    wrong = [_beside(scan, one, buffer) for scan, one in clean]
    expect(
        "the points are where the walls are",
        sum(one > EXACT for one in wrong) <= 0.1 * len(wrong),
        f"Most are {sorted(wrong)[len(wrong) // 2]:.2f} m beside their place, one {max(wrong):.2f} m. "
        f"{_wall_cause(clean, buffer)}",
    )
    is_clean = sum(one > EXACT for one in wrong) <= 0.1 * len(wrong)
    missed = [(scan, one) for scan, one in spoilt_ones if _beside(scan, one, buffer) > EXACT]
    expect(
        "what is no hit is left out",
        is_clean and len(spoilt_ones) > 0.6 * sum(spoilt for _, spoilt in sent) and len(missed) <= 0.1 * len(sent),
        f"Of {sum(spoilt for _, spoilt in sent)} scans that had ranges like nan, -inf, 0.0, or beyond range_max, "
        f"{len(spoilt_ones) - len(missed)} have the right point. A hit is between range_min and range_max: "
        "`min` of ranges with a nan or a 0 in it is none, and comparisons with nan are always false.",
    )


def _has(told: dict[float, Any], scan: LaserScan) -> bool:
    return seconds_of(scan.header.stamp) in told


def _nearest(scan: LaserScan) -> Point:
    """The nearest hit, seen from the laser."""
    hits = [(r, n) for n, r in enumerate(scan.ranges) if scan.range_min <= r <= scan.range_max]
    distance, number = min(hits)
    angle = scan.angle_min + number * scan.angle_increment
    return distance * math.cos(angle), distance * math.sin(angle)


def _beside(scan: LaserScan, told: Any, buffer: Any, frame: str = "base_scan", later: float = 0.0) -> float:
    """Metres from a point that was told to where the nearest hit of the scan is, or would be from elsewhere."""
    stamp = type(scan.header.stamp)()
    nanoseconds = round((seconds_of(scan.header.stamp) + later) * 1e9)
    stamp.sec, stamp.nanosec = divmod(nanoseconds, 1_000_000_000)
    place = place_in(buffer, "odom", frame, stamp)
    if place is None:
        return 0.0 if not later and frame == "base_scan" else math.inf
    return math.dist(after(place, (*_nearest(scan), 0.0))[:2], (told.point.x, told.point.y))


def _wall_cause(pairs: list[tuple[LaserScan, Any]], buffer: Any) -> str:
    def most(is_so: Callable[[LaserScan, Any], bool]) -> bool:
        return sum(is_so(scan, one) for scan, one in pairs) > 0.6 * len(pairs)

    if most(lambda scan, one: math.dist(_nearest(scan), (one.point.x, one.point.y)) < EXACT):
        return "They are as the laser sees them, under the name of odom: transform them first."
    if most(lambda scan, one: _beside(scan, one, buffer, "base_link") < EXACT):
        return "They are 3 cm behind: the ranges are seen from the laser, so the source is scan.header.frame_id."
    if most(lambda scan, one: min(_beside(scan, one, buffer, later=n * 0.025) for n in range(2, 20)) < EXACT):
        return (
            "They are where they would be if the scan were new: ask tf2 for the scan's stamp, "
            "`Time.from_msg(scan.header.stamp)`; `Time()` is the latest, and the robot has turned since."
        )
    return (
        "The beam number n has the angle angle_min + n · angle_increment, in radians; the nearest hit is the smallest "
        "range between range_min and range_max; `lookup_transform(target, source, …)` brings it into the target."
    )
