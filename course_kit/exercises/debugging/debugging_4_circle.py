"""The check of debugging-4: a bag of a turtle that drives a circle."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from course_kit.base.arguments import shown
from course_kit.exercises.checker.assertions import expect, require
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.examination import current
from course_kit.lab import bags
from course_kit.robots.turtlesim import paths
from course_kit.robots.turtlesim.turtle import TICK

POSES, COMMANDS = "/turtle1/pose", "/turtle1/cmd_vel"
TYPES = {POSES: "turtlesim/msg/Pose", COMMANDS: "geometry_msgs/msg/Twist"}
SHORTEST = 5.0  # seconds
SPEED = 0.99  # m/s
ROUND = 0.97 * math.tau  # radians
OFF = 0.1  # of the radius, that a point of a circle may be beside it
STARTS = 1000  # poses at which a round may begin
HELD = 1.3  # seconds that a command holds, and a little for its way into the bag
LATE = 0.1  # seconds that it may be written after the first pose that follows it
MOST = 0.8

Stamped = tuple[int, Any]  # nanoseconds, message


@check_of("debugging-4")
def circle(value: Any) -> None:
    """A bag with the two topics and nothing else, in which the turtle goes round."""
    require(
        "the answer is the path of a bag", isinstance(value, str), f'You gave {shown(value)}: a text, such as "circle".'
    )
    heard: dict[str, list[Stamped]] = {topic: [] for topic in TYPES}
    bag, hint = None, ""
    try:
        bag = bags.info(current().folder / Path(value).expanduser())
        there = {topic.name: topic.type for topic in bag.topics if topic.count}
        known = [topic for topic in TYPES if there.get(topic) == TYPES[topic]]
        for topic, when, message in bags.read(bag.path, *known) if known else ():
            heard[topic].append((when, message))
    except (bags.BagError, OSError, ValueError) as error:
        bag, hint = None, f"{error} The path is seen from the folder in which the notebook lies."
    require("there is a bag", bag is not None, hint)
    times = [when for messages in heard.values() for when, _ in messages]
    seconds = (max(times) - min(times)) * 1e-9 if times else 0.0
    expect(
        "it has both topics and nothing else, for at least 5 s",
        there == TYPES and all(heard.values()) and seconds >= SHORTEST,
        f"It has messages of {', '.join(sorted(there)) or 'nothing'}, and those of the two are {seconds:.1f} s long: "
        f"name the topics to `bags.record(…)`, and drive while it records.",
    )
    hint = _why_not_round(heard[POSES], heard[COMMANDS])
    expect("the turtle goes round in a circle, at 1 m/s or more", not hint, hint)


@dataclass(frozen=True)
class _Round:
    """A part of a bag in which the heading turns once."""

    poses: Sequence[Stamped]
    radius: float  # metres, of the circle that fits best
    off: float  # metres, from it to the point that is farthest from it

    @property
    def is_circle(self) -> bool:
        return self.off <= OFF * self.radius and self.slowest > 0

    @property
    def slowest(self) -> float:
        """Metres a second."""
        return min(float(pose.linear_velocity) for _, pose in self.poses)

    @property
    def moves_as_it_says(self) -> bool:
        """The places follow from the velocities, but where poses are missing."""
        steps = [
            math.dist((a.x, a.y), (b.x, b.y)) / (TICK * max(b.linear_velocity, 1e-6))
            for (_, a), (_, b) in zip(self.poses, self.poses[1:], strict=False)
        ]
        return 0.8 <= float(np.median(steps)) <= 1.25

    def obeys(self, commands: Sequence[Stamped]) -> bool:
        """Nearly all velocities are those of a command that was in force."""
        times = np.array([when for when, _ in commands])

        def is_ordered(when: int, pose: Any) -> bool:
            first, last = np.searchsorted(times, [when - HELD * 1e9, when + LATE * 1e9])
            return any(
                math.isclose(math.hypot(c.linear.x, c.linear.y), pose.linear_velocity, rel_tol=0.01, abs_tol=0.01)
                or math.isclose(abs(c.linear.x), pose.linear_velocity, rel_tol=0.01, abs_tol=0.01)
                for _, c in commands[first:last]
                if math.isclose(c.angular.z, pose.angular_velocity, rel_tol=0.01, abs_tol=0.01)
            )

        return sum(is_ordered(*pose) for pose in self.poses) >= MOST * len(self.poses)


def _rounds(poses: Sequence[Stamped]) -> Iterator[_Round]:
    """The rounds of a turtle that moves; where it rests the time stands still."""
    moving = [(when, pose) for when, pose in poses if pose.linear_velocity or pose.angular_velocity]
    turned = np.array(paths.headings([pose for _, pose in moving]) if moving else [])
    for first in range(0, len(moving), max(1, len(moving) // STARTS)):
        has_turned = np.abs(turned[first:] - turned[first]) >= ROUND
        if not has_turned.any():
            continue
        part = moving[first : first + int(has_turned.argmax()) + 1]
        yield _Round(part, *_fit(np.array([(pose.x, pose.y) for _, pose in part])))


def _fit(points: npt.NDArray[np.float64]) -> tuple[float, float]:
    """The radius of the circle that fits points best, and how far the farthest one is from it."""
    equations = np.column_stack([2 * points, np.ones(len(points))])
    x, y, rest = np.linalg.lstsq(equations, (points**2).sum(axis=1), rcond=None)[0]
    radius = math.sqrt(max(0.0, rest + x * x + y * y))
    return radius, float(np.abs(np.hypot(points[:, 0] - x, points[:, 1] - y) - radius).max())


def _why_not_round(poses: Sequence[Stamped], commands: Sequence[Stamped]) -> str:
    """Nothing if there is a circle; else what keeps the turtle from having driven one."""
    circles = []
    for one in _rounds(poses):
        if one.is_circle and one.slowest >= SPEED and one.moves_as_it_says and (not commands or one.obeys(commands)):
            return ""
        circles += [one] * one.is_circle
    messages = [pose for _, pose in poses]
    turned = math.degrees(abs(paths.headings(messages)[-1])) if messages else 0.0
    fastest = max((one.slowest for one in circles), default=0.0)
    if fastest >= SPEED:
        return (
            "A turtle that gets the commands of the bag moves otherwise than the poses say: record both at the same "
            "time, with the turtle's own poses."
        )
    if circles:
        return f"It goes round, at {fastest:.1f} m/s where it is slowest: give `linear.x` 1.0 or more all the time."
    return (
        f"In the bag it turns by {turned:.0f}° in all and drives at {paths.top_speed(messages):.1f} m/s at most, but "
        f"never round on one circle: drive and turn at the same time. A circle takes 2π / angular.z seconds."
    )
