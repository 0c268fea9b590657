"""Chapter 3's exercises: what each asks of topics, and how it is checked."""

from __future__ import annotations

import math
from itertools import pairwise

from geometry_msgs.msg import Twist
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Int32
from turtlesim.msg import Pose

from course_kit.examining import paths
from course_kit.examining.exercise import exercise
from course_kit.examining.station import Heard
from course_kit.examining.vocabulary import a_turtle, answer, expect, pause, require, wait, wait_for_attribute
from course_kit.examining.vocabulary_topics import (
    expect_compatible_subscription,
    expect_rate,
    expect_subscription,
    expect_topic,
    hear_the_turtle,
    listen,
    publish_steadily,
    publisher,
    values,
    wait_until_quiet,
)


@exercise("topics-1", "Count down", points=2, level="warm-up", node_class="Countdown")
def count_down() -> None:
    """It publishes 10, 9, … 0, five a second, from when somebody listens, and then no more."""
    answer()
    expect_topic("/countdown", Int32)
    pause(0.5)  # nobody listens yet, so nothing may be counted
    heard = listen("/countdown", Int32)
    wait_until_quiet(heard, 1.2, timeout=6.0, at_most=14)
    counted = values(heard, "data")
    expect("it counts 10, 9, … 0 and stops", counted == list(range(10, -1, -1)), _why_not_ten(counted))
    expect_rate(heard, 5.0, within=0.1)


def _why_not_ten(counted: list[int]) -> str:
    if not counted:
        return "Nothing came. Does its timer wait for `self.publisher.get_subscription_count()`, and then publish?"
    heard = f"Heard: {', '.join(map(str, counted[:14]))}."
    if counted == list(range(0, 11)):
        return f"{heard} It counts up."
    if counted[0] < 10:
        return (
            f"{heard} The first numbers went to nobody: a message that is sent before a subscription has matched is "
            f"lost. Count only when `self.publisher.get_subscription_count()` is more than 0."
        )
    if len(counted) > 11:
        return f"{heard} It goes on after 0: cancel the timer, or return before it publishes."
    return f"{heard} It should be 10, 9, … 0, each once."


@exercise("topics-2", "Why does nothing arrive?", points=2, level="medium", node_class="ScanCounter")
def sensor_qos() -> None:
    """It hears a laser that publishes with the sensors' QoS, and counts its scans."""
    laser = publisher("/scan", LaserScan, qos_profile_sensor_data)
    answer()
    expect_subscription("/scan", LaserScan)
    expect_compatible_subscription("/scan", laser, points=1)
    publish_steadily(laser, [LaserScan(ranges=[1.0, 2.0, 3.0])] * 20, period=0.02)
    count = wait_for_attribute("count", lambda count: count == 20, timeout=1.0)
    is_right = isinstance(count, int) and 18 <= count <= 20  # best effort: a busy machine may lose one
    expect(
        "it counts 20 scans in `self.count`",
        is_right,
        f"`self.count` is {count!r} after 20 scans: begin with 0 and add 1 in the callback, for each message.",
    )


@exercise("topics-3", "A relay", points=3, level="medium", node_class="Relay")
def relay() -> None:
    """Of the poses on /turtle1/pose it publishes every tenth, unchanged, on /turtle1/pose_slow."""
    answer()
    expect_subscription("/turtle1/pose", Pose)
    expect_topic("/turtle1/pose_slow", Pose)
    turtle = publisher("/turtle1/pose", Pose)
    expect_compatible_subscription("/turtle1/pose", turtle)
    slow = listen("/turtle1/pose_slow", Pose)
    pause(0.3)
    publish_steadily(turtle, [Pose(x=float(number), theta=0.5) for number in range(1, 161)], period=0.016)
    pause(0.3)
    numbers = [round(x) for x in values(slow, "x")]
    count = len(numbers)
    expect(
        "what it publishes are poses that it got",
        count and all(1 <= n <= 160 for n in numbers) and all(theta == 0.5 for theta in values(slow, "theta")),
        "Nothing came on `/turtle1/pose_slow`." if not count else "Publish the message that the callback was given.",
        needed=not count,
    )
    steps = sorted(after - before for before, after in pairwise(numbers))
    step = steps[len(steps) // 2] if steps else 0
    expect(
        "it is every tenth pose",
        step == 10 and 14 <= count <= 17,
        f"Of 160 poses {count} came, most of them {step} after the one before: count the calls of the callback, "
        f"and publish when the count divides by 10.",
    )
    expect_rate(slow, 6.25, within=0.15, hint="A tenth of 62.5 is 6.25.")


@exercise("topics-4", "A figure of eight", points=5, level="project", timeout=75, node_class="FigureEight")
def figure_of_eight() -> None:
    """The turtle drives two circles of the same size, one to the left and one to the right, and is back."""
    a_turtle()
    driven = hear_the_turtle()
    answer()
    expect_topic("/turtle1/cmd_vel", Twist)
    poses = _drive_until_it_stands(driven)
    first, second = paths.two_loops(poses)
    circle, tolerance = math.tau, 0.15 * math.tau
    expect(
        "the first circle is a whole one",
        abs(abs(first.turned) - circle) < tolerance,
        f"It turned by {_degrees(first.turned)} before it turned the other way, or to its end: "
        f"a circle takes 2π / angular.z seconds.",
    )
    expect(
        "the second circle is a whole one, the other way round",
        abs(abs(second.turned) - circle) < tolerance and first.turned * second.turned < 0,
        f"After the first it turned by {_degrees(second.turned)}: "
        f"the second circle has the opposite sign of angular.z, and takes as long.",
    )
    longer, shorter = max(first.length, second.length), min(first.length, second.length)
    expect(
        "both have the same size",
        shorter > 0.85 * longer and shorter > 1.0,
        f"Their lengths are {first.length:.1f} m and {second.length:.1f} m: "
        f"the radius is linear.x / angular.z, and a wall cuts a circle short.",
    )
    missing = paths.gap(poses)
    expect(
        "the figure is closed within 0.3 m",
        missing <= 0.3,
        f"It ends {missing:.2f} m from where it began: send commands at each tick and count the ticks, or close the "
        f"loop with the pose.",
        points=2,
    )


def _drive_until_it_stands(driven: Heard) -> list[Pose]:
    """What was driven until the turtle stood still for a second."""
    began = wait(lambda: driven.messages and _moves(driven.last), timeout=10.0)
    require(
        "the turtle moves",
        began,
        "It stands still after 10 s: does the node publish on `/turtle1/cmd_vel` again and again? "
        "`%ros2 topic echo /turtle1/cmd_vel` shows it.",
    )
    wait(lambda: _stands(driven) or _turned(driven) > 3 * math.tau, timeout=55.0, poll=0.1)
    require(
        "it stops at the end",
        _stands(driven),
        f"It still moves after {len(driven) * 0.016:.0f} s: stop, and publish no more, when both circles are done.",
    )
    return driven.messages


def _moves(pose: Pose) -> bool:
    return bool(pose.linear_velocity or pose.angular_velocity)


def _stands(driven: Heard) -> bool:
    """For a second."""
    return not any(map(_moves, driven.messages[-62:]))


def _turned(driven: Heard) -> float:
    """Radians in all, to the left or to the right."""
    headings = paths.headings(driven.messages)
    return sum(abs(b - a) for a, b in pairwise(headings))


def _degrees(radians: float) -> str:
    return f"{math.degrees(radians):.0f}°"
