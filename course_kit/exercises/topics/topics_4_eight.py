"""The check of topics-4: a turtle drives a figure of eight."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

from geometry_msgs.msg import Twist
from turtlesim.msg import Pose

from course_kit.exercises.checker import circles
from course_kit.exercises.checker.assertions import (
    a_turtle,
    answer,
    chance,
    expect,
    nobody_else,
    place_turtle,
    require,
    time_left,
    wait,
)
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.topic_assertions import expect_topic, hear_the_turtle, ticked_late
from course_kit.robots.turtlesim import paths
from course_kit.robots.turtlesim.field import MIDDLE
from course_kit.robots.turtlesim.node import TurtleSim
from course_kit.robots.turtlesim.turtle import TICK
from course_kit.ros.observing.received_messages import ReceivedMessages

OFF_MIDDLE = 0.35  # metres at most, in x and in y: there is room for two circles of 2.5 m, whatever the heading
FIGURES = 3  # at most, where a simulator that ticked late led the turtle astray
BEGIN_TIMEOUT = 10.0
DRIVE_TIMEOUT = 90.0  # seconds of driving; two circles of 2.5 m at 0.5 m/s take 63 s
REST = 3.0  # seconds for which the turtle may stand between the circles
LOOK = 0.1  # seconds from one look at it to the next
LOOKS = round(1.1 * REST / LOOK)  # in a little more than a rest
TURNED = 6 * math.tau  # radians, three times those of two circles, after which it goes on for ever
WHOLE = 0.1  # of a turn that may be missing or too much
ROUND = 0.1  # of the radius
ALIKE = 0.85  # the smaller circle's length as a part of the larger one's, at least
CLOSED = 0.3  # metres
AROUND = 1.0  # metres around a circle, at least
BESIDE = 0.12  # of their width, by which the middles of two circles may be nearer or farther
KILLED = "turtle1 was killed: drive it, and leave it where it arrives."


@dataclass(frozen=True)
class Figure:
    """What was driven, taken for two circles."""

    first: circles.Circle
    second: circles.Circle
    missing: float  # metres from its end to its beginning
    length: float  # metres
    was_disturbed: bool

    @property
    def goes_on_beside(self) -> bool:
        """True if the second circle is as it should be after the first."""
        first, second = self.first, self.second
        return _is_whole(second) and first.turned * second.turned < 0 and _touch(first, second)

    @property
    def is_even(self) -> bool:
        """True if both circles have the same size, and no small one."""
        lengths = self.first.length, self.second.length
        return min(lengths) > ALIKE * max(lengths) and min(lengths) > AROUND

    @property
    def is_closed(self) -> bool:
        """True if it ends where it began."""
        return self.missing <= CLOSED and self.length > AROUND  # it has not stood still

    @property
    def is_right(self) -> bool:
        """True if nothing is missing."""
        return _is_whole(self.first) and self.goes_on_beside and self.is_even and self.is_closed


@check_of("topics-4")
def figure_of_eight() -> None:
    """From near the middle the turtle drives two circles of the same size, one to each side, and is back."""
    turtlesim = a_turtle()
    driven = hear_the_turtle()
    nobody_else("rt/turtle1/cmd_vel")
    for _ in range(FIGURES):
        began = time.monotonic()
        figure = _drive(turtlesim, driven)
        is_judged = figure.is_right or not figure.was_disturbed
        if is_judged or time_left() < time.monotonic() - began + BEGIN_TIMEOUT:
            break
    first, second = figure.first, figure.second
    expect("the first circle is a whole one", _is_whole(first), _why_not_whole(first, "It turned by"))
    expect(
        "the second circle is a whole one, the other way round, beside the first",
        figure.goes_on_beside,
        _why_not_the_second(first, second),
    )
    expect(
        "both have the same size, a metre around at least",
        figure.is_even,
        f"Their lengths are {first.length:.1f} m and {second.length:.1f} m: "
        f"the radius is linear.x / angular.z, and a wall cuts a circle short.",
    )
    expect(
        f"the figure is closed within {CLOSED} m",
        figure.is_closed,
        f"It ends {figure.missing:.2f} m from where it began, after {figure.length:.1f} m: send commands at each tick "
        f"and count the ticks, or close the loop with the pose.",
        points=2,
    )


def _drive(turtlesim: TurtleSim, driven: ReceivedMessages) -> Figure:
    """What a new node drives from somewhere near the middle."""
    x, y = (MIDDLE + chance().uniform(-OFF_MIDDLE, OFF_MIDDLE) for _ in range(2))
    place_turtle(turtlesim, x, y, chance().uniform(-math.pi, math.pi))
    before = len(driven)
    answer(threads=None)
    expect_topic("/turtle1/cmd_vel", Twist)
    poses = _drive_until_it_stands(turtlesim, driven, before)
    require(
        "it is driven, not teleported",
        not circles.has_jump(poses),
        "It came farther than its velocity brought it: drive it by `/turtle1/cmd_vel` alone, to its end.",
    )
    return Figure(*circles.two_circles(poses), paths.gap(poses), paths.length(poses), ticked_late(driven, before))


def _drive_until_it_stands(turtlesim: TurtleSim, driven: ReceivedMessages, before: int) -> list[Pose]:
    """What was driven after so many poses: from the first motion until the turtle stood still for more than a rest."""

    def is_there() -> bool:
        return "turtle1" in turtlesim.world.turtles

    wait(lambda: _moves(driven.last) or not is_there(), BEGIN_TIMEOUT)
    require(
        "the turtle moves",
        any(map(_moves, driven.messages[before:])),
        "It stands still after 10 s: does the node publish on `/turtle1/cmd_vel` again and again? "
        "`%ros2 topic echo /turtle1/cmd_vel` shows it."
        if is_there()
        else KILLED,
    )
    # Reading all poses again and again would keep the simulator, a thread beside this one, from ticking in time.
    seen: list[Pose] = []

    def is_over() -> bool:
        seen.append(driven.last)
        stands = len(seen) >= LOOKS and not any(map(_moves, seen[-LOOKS:]))
        return stands or not is_there() or (len(seen) % 20 == 0 and circles.turned_in_all(seen) > TURNED)

    wait(is_over, DRIVE_TIMEOUT + 1.5 * REST, poll=LOOK)
    require("turtle1 is still there", is_there(), KILLED)
    poses = driven.messages[before:]
    require(
        "it stops at the end",
        not any(map(_moves, poses[-round(REST / TICK) :])),
        f"It still moves after {len(poses) * TICK:.0f} s: stop, and publish no more, when both circles are done.",
    )
    begin = next(place for place, pose in enumerate(poses) if _moves(pose))
    return poses[max(0, begin - 1) :]


def _moves(pose: Pose) -> bool:
    return bool(pose.linear_velocity or pose.angular_velocity)


def _is_whole(circle: circles.Circle) -> bool:
    return abs(abs(circle.turned) - math.tau) < WHOLE * math.tau and circle.error < ROUND


def _touch(first: circles.Circle, second: circles.Circle) -> bool:
    """Beside each other: their middles are as far apart as they are wide."""
    wide = first.radius + second.radius
    return abs(math.dist(first.middle, second.middle) - wide) < BESIDE * wide


def _why_not_whole(circle: circles.Circle, so: str) -> str:
    if abs(circle.turned) > 1.5 * math.tau:
        return (
            f"{so} {_degrees(circle.turned)}, more than one circle, before it turned the other way, or to its end: "
            f"two circles make the figure, one to each side."
        )
    if circle.error >= ROUND:
        return (
            f"{so} {_degrees(circle.turned)}, and came {circle.error:.0%} of the radius off a circle: linear.x and "
            f"angular.z stay as they are for a whole circle, and a wall cuts it short."
        )
    return (
        f"{so} {_degrees(circle.turned)} before it turned the other way, or to its end: "
        f"a circle takes 2π / angular.z seconds."
    )


def _why_not_the_second(first: circles.Circle, second: circles.Circle) -> str:
    if _is_whole(first) and not _is_whole(second) and second.length > 1.5 * first.length:
        return (
            f"After a circle of {first.length:.1f} m it drove {second.length:.1f} m, which is more than one circle: "
            f"two circles make the figure, one to each side."
        )
    if second.error >= ROUND:
        return _why_not_whole(second, "After the first it turned by")
    if _is_whole(second) and first.turned * second.turned < 0:
        return (
            "It lies over the first: go on from where the first ends with the heading that you have there, and with "
            "the opposite sign of angular.z."
        )
    return (
        f"After the first it turned by {_degrees(second.turned)}: "
        f"the second circle has the opposite sign of angular.z, and takes as long."
    )


def _degrees(radians: float) -> str:
    return f"{math.degrees(radians):.0f}°"
