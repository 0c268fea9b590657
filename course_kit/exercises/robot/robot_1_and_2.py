"""Chapter 7's exercises on frames: what each asks, and how it is checked."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable
from typing import Any

from geometry_msgs.msg import PointStamped
from sensor_msgs.msg import LaserScan

from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.late_scans import LASER, REMAPPED, LateScans
from course_kit.exercises.checker.vocabulary import answer, chance, expect, raised, require, wait
from course_kit.exercises.checker.vocabulary_robot import (
    PACED,
    Pace,
    a_robot,
    drive,
    expect_stamped,
    hear_robot,
    hear_tf,
    place_in,
    seconds_of,
    wait_simulated,
)
from course_kit.exercises.checker.vocabulary_topics import expect_compatible_subscription, expect_topic, listen
from course_kit.robots.navigation.places import Place, after, inverse

Point = tuple[float, float]
WRONG = 0.06  # m, of a point that moves with the robot
EARLIER, LATER = 0.15, 0.06  # s around a stamp: the latest transform, or the time now
RATE, WITHIN = 5.0, 0.2
ARC = 5.0  # simulated s
AHEAD: Place = (1.0, 0.0, 0.0)

EXACT = 0.02  # m, of a point whose stamp is that of a scan
OLDEST = 0.3  # s after its stamp at which a scan comes at the latest
SILENT = 0.7  # s from point to point: more than a scan that comes late, and whose point comes with the next one
TURN = 9.0  # simulated s for which the robot turns
ENOUGH = 0.8  # of the scans, for who is late on a busy machine


@check_of("robot-1")
def ahead_of_robot() -> None:
    """It publishes five times a second the point that is 1 m ahead of the robot, in odom."""
    robot = a_robot("empty", start=(3.0, 2.5, chance().uniform(-3.0, 3.0)), patience=PACED)
    drive(robot, 0.2, 0.0, chance().uniform(1.0, 2.5), timeout=20.0)  # so that odometry is not 0 when it begins
    answer(use_sim_time=True)
    expect_topic("/ahead_of_robot", PointStamped)
    transforms, points = hear_tf(), listen("/ahead_of_robot", PointStamped)
    side, pace = chance().choice((1, -1)), Pace(robot, points, 1.5 / RATE)
    for turning in (side * chance().uniform(0.7, 0.9), -side * chance().uniform(0.4, 0.6)):
        drive(robot, chance().uniform(0.1, 0.18), turning, ARC, timeout=30.0, pace=pace)
    wait_simulated(robot, 0.5, timeout=10.0)
    heard = points.messages
    require(
        "points come",
        len(heard) > RATE,
        f"{len(heard)} came in {2 * ARC:g} s of simulated time. A timer with a period of 1 / {RATE:g} s; and "
        "`lookup_transform` raises as long as nothing is known, so the first ticks have no point.",
    )
    frames = {one.header.frame_id for one in heard}
    require(
        "the points are in the frame `odom`",
        frames == {"odom"},
        f"Their header says {', '.join(sorted(map(repr, frames)))}. `do_transform_point` takes over the frame of the "
        "transform's header: look up the transform that brings points from base_link into odom.",
    )
    expect_stamped("they are stamped", heard, robot)
    track = transforms.track("odom", "base_link")
    wrong = [one for one in heard if _away(one, track, AHEAD) > WRONG]
    worst = wrong[-1] if wrong else heard[-1]
    expect(
        "each is 1 m ahead of the robot",
        len(wrong) <= 0.05 * len(heard),
        f"At {seconds_of(worst.header.stamp):.2f} s the point was ({worst.point.x:.2f}, {worst.point.y:.2f}), "
        f"{_away(worst, track, AHEAD):.2f} m beside that place. {_cause(heard, track)}",
    )
    stamps = sorted({seconds_of(one.header.stamp) for one in heard})
    rate = (len(heard) - 1) / max(stamps[-1] - stamps[0], 1e-3)
    expect(
        "it publishes five a second, by simulated time",
        abs(rate - RATE) <= WITHIN * RATE and len(stamps) > 0.8 * len(heard),
        f"{len(heard)} points came with {len(stamps)} stamps, {rate:.1f} for each second of these. "
        + (
            "Look the transform up for each point, in the timer's callback: it is that of one moment."
            if len(stamps) <= 0.8 * len(heard)
            else f"A timer of the node with a period of {1 / RATE:g} s goes by simulated time, by `use_sim_time`."
        ),
    )


def _away(point: Any, track: list[tuple[float, Place]], step: Place) -> float:
    """Metres from a point to where this step led from the robot, at about that time; inf for a time without any."""
    stamp = seconds_of(point.header.stamp)
    times = [time for time, _ in track]
    # Before the first place that was heard it stood there already.
    near = track[:1] if times and stamp < times[0] else []
    near += track[bisect_left(times, stamp - EARLIER) : bisect_right(times, stamp + LATER)]
    places = [after(place, step) for _, place in near]
    return min((math.dist(place[:2], (point.point.x, point.point.y)) for place in places), default=math.inf)


def _cause(points: list[Any], track: list[tuple[float, Place]]) -> str:
    """What most of the points are in place of what they should be."""

    def are(change: Callable[[Place], Place], step: Place = AHEAD) -> bool:
        other = [(time, change(place)) for time, place in track]
        return sum(_away(one, other, step) < WRONG for one in points) > 0.7 * len(points)

    first = points[0].point
    if all(math.dist((one.point.x, one.point.y), (1.0, 0.0)) < 1e-3 for one in points):
        return "That is the point as it is in base_link, under the name of odom: transform it, then publish it."
    if all(math.dist((one.point.x, one.point.y), (first.x, first.y)) < 1e-3 for one in points):
        return "All points are the same: look the transform up for each of them, in the timer's callback."
    if are(inverse):
        return (
            "That is where base_link's numbers lie the other way round: `lookup_transform(target, source, …)` brings "
            "points from the source into the target, so the target is odom."
        )
    if are(lambda place: (place[0], place[1], math.degrees(place[2]))):
        return "The heading went into the cosine in degrees: ROS and Python have radians."
    if are(lambda place: place, (0.0, 0.0, 0.0)):
        return "That is the robot itself: 1 m ahead of it is the point (1, 0) of base_link."
    if are(lambda place: place, (0.0, 1.0, 0.0)) or are(lambda place: place, (0.0, -1.0, 0.0)):
        return "That is beside the robot: x is ahead, y to the left."
    if are(lambda place: (place[0], place[1], 0.0)):
        return "It is 1 m along the x axis of odom: the robot has a heading, so rotate (1, 0) before you add it."
    return "Look up odom → base_link for each point, and transform (1, 0) with it, by `do_transform_point`."


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
