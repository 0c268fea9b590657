"""The check of robot-1: a point ahead of the robot, in the frame odom."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable
from typing import Any

from geometry_msgs.msg import PointStamped

from course_kit.exercises.checker.assertions import answer, chance, expect, require
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.robot_fixtures import (
    PACED,
    Pace,
    a_robot,
    drive,
    expect_stamped,
    hear_tf,
    seconds_of,
    wait_simulated,
)
from course_kit.exercises.checker.topic_assertions import expect_topic, listen
from course_kit.robots.navigation.places import Place, after, inverse

WRONG = 0.06  # m, of a point that moves with the robot
EARLIER, LATER = 0.15, 0.06  # s around a stamp: the latest transform, or the time now
RATE, WITHIN = 5.0, 0.2
ARC = 5.0  # simulated s
AHEAD: Place = (1.0, 0.0, 0.0)


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
