"""The check of debugging-5: a distance that teleports do not count in."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from rclpy.publisher import Publisher
from std_msgs.msg import Float32
from turtlesim.msg import Pose

from course_kit.exercises.checker.assertions import answer, chance, expect, pause, wait
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.examination import current
from course_kit.exercises.checker.topic_assertions import (
    expect_compatible_subscription,
    expect_subscription,
    expect_topic,
    listen,
    publisher,
    values,
)
from course_kit.robots.turtlesim.turtle import TICK
from course_kit.ros.observing.received_messages import ReceivedMessages

POSES, MILEAGE, NODE = "/turtle1/pose", "/mileage", "/mileage"
JUMP = 0.2  # metres, above which a step does not count
JUST_BELOW, JUST_ABOVE = 0.196, 0.204  # metres; positions are float32
JUMPS = ((JUST_ABOVE, JUST_ABOVE), (0.25, 0.5), (0.5, 0.95), (1.0, 3.0), (3.0, 7.0))  # metres, from and to
FIELD = 11.0  # metres, both ways
START, FROM_START = 5.544445, (0.03, 0.12)  # metres; where a turtle begins, and how far from there it does here
OFF = 0.01  # metres
SLOW, SLOW_STEPS = (0.002, 0.009), (15, 20)  # metres of a step, and how many: together more than OFF
DRIVING = (1.0, 3.0)  # m/s of a turtle that is teleported, or held by the wall
DIAGONAL = 0.2  # radians that the shortest jumps are off a diagonal, where both coordinates change by less than JUMP
ANSWER_TIMEOUT = 1.0
MISSES = 3  # poses without an answer, after which no answer is waited for
EXTRA = 0.2  # seconds in which nothing more may come


@check_of("debugging-5")
def mileage() -> None:
    """It adds up what was driven, without what was jumped."""
    turtle = publisher(POSES, Pose)
    starts = [0.0, START]  # where a variable may begin, and a turtle does
    chance().shuffle(starts)
    legs = [leg for start in starts for leg in _legs(turtle, start + chance().uniform(*FROM_START))]
    short = next((leg for leg in legs if not leg.is_complete), legs[0])
    expect(
        "it publishes once for each pose, beginning with 0",
        all(leg.is_complete for leg in legs),
        f"For {len(short.wanted)} poses there were {len(short.said)} messages, the first of them "
        f"{f'{short.said[0]:.2f}' if short.said else 'missing'}: publish in the callback of the pose, also for the "
        f"first one, and once.",
        needed=not all(leg.said for leg in legs),
    )
    off = next((leg.off for leg in legs if leg.off and not leg.jumps), "")
    expect("what is driven counts", not off, f"{off}. Add `math.dist` of the places of one pose and the one before.")
    off = next((leg.off for leg in legs if leg.off and leg.jumps), "")
    expect(
        "a teleport does not count, and what comes after it does",
        not off,
        f"{off}. Leave out a step of more than 0.2 m, and go on from where the turtle is then.",
    )


def _legs(turtle: Publisher, start: float) -> list[_Leg]:
    """A new node is driven without a jump, and then with some."""
    _end_the_node()
    answer(threads=None)
    expect_subscription(POSES, Pose)
    expect_topic(MILEAGE, Float32)
    expect_compatible_subscription(POSES, turtle)
    heard = listen(MILEAGE, Float32)
    wait(lambda: heard.publisher_count > 0, 3.0)
    track = _Track(start)
    track.drive(chance().randint(20, 30))
    track.creep()
    driven = track.send(turtle, heard, 0.0)
    jumps = [chance().uniform(*bounds) for bounds in JUMPS]
    chance().shuffle(jumps)
    for jump in jumps:
        track.step(jump)
        track.drive(chance().randint(0, 5))
    track.creep()
    return [driven, track.send(turtle, heard, driven.said[-1] if driven.said else 0.0)]


def _end_the_node() -> None:
    """Stop the node of the answer, if there is one: else it would be taken for the next, which has its name."""
    test_domain = current().test_domain
    current().order("stop")
    wait(
        lambda: NODE not in test_domain.their_nodes() and not test_domain.publishers(MILEAGE),
        3.0,
        "the end of the first node",
    )


@dataclass
class _Leg:
    """What was sent to a node, and what it said."""

    said: list[float]
    wanted: list[float]  # metres after each pose
    said_before: float  # the last of what it said before
    wanted_before: float
    jumps: list[float]  # metres

    @property
    def is_complete(self) -> bool:
        """True if it said one thing for each pose, and 0 for the very first."""
        return len(self.said) == len(self.wanted) and (self.wanted[0] != 0.0 or abs(self.said[0]) < 1e-6)

    @property
    def off(self) -> str:
        """Nothing if it added what was driven; of a node that did not say all only the end is looked at."""
        if not self.said:
            return ""
        pairs = list(zip(self.wanted, self.said, strict=False))
        pairs = pairs if len(self.said) == len(self.wanted) else [(self.wanted[-1], self.said[-1])]
        added = [(wanted - self.wanted_before, said - self.said_before) for wanted, said in pairs]
        wrong = next(((wanted, said) for wanted, said in added if not abs(wanted - said) <= OFF), None)
        if wrong is None:
            return ""
        jumps = f", between jumps of {', '.join(f'{jump:.2f}' for jump in self.jumps)} m" if self.jumps else ""
        return f"The turtle drove {wrong[0]:.2f} m{jumps}, and it added {wrong[1]:.2f} m"


class _Track:
    """The poses of a turtle that drives and jumps, the way that counts, and how far of it was sent."""

    def __init__(self, start: float) -> None:
        self._poses, self._wanted = [Pose(x=start, y=start)], [0.0]
        self._jumps: list[float] = []
        self._sent = 0

    def step(self, length: float) -> None:
        """Go a way in some direction, forwards or backwards."""
        before, is_driven = self._poses[-1], length <= JUMP
        x = y = course = -1.0
        while not (0.0 < x < FIELD and 0.0 < y < FIELD):
            course = chance().uniform(-math.pi, math.pi)
            if not is_driven and length < 1.3 * JUMP:
                course = math.pi / 4 + chance().randrange(4) * math.pi / 2 + chance().uniform(-DIAGONAL, DIAGONAL)
            x, y = (float(np.float32(at + length * along)) for at, along in _along(before, course))
        speed = length / TICK if 0.0 < length < 2 * JUMP else chance().uniform(*DRIVING)
        backwards = chance().random() < 0.3
        theta = math.remainder(course + math.pi * backwards, math.tau)
        self._poses.append(Pose(x=x, y=y, theta=theta, linear_velocity=-speed if backwards else speed))
        self._wanted.append(self._wanted[-1] + math.dist((x, y), (before.x, before.y)) * is_driven)
        self._jumps += [] if is_driven else [length]

    def drive(self, count: int) -> None:
        """So many steps, one that just counts, and one in which the turtle stands, at the wall perhaps."""
        steps = [*(chance().uniform(0.01, 0.19) for _ in range(count)), JUST_BELOW, 0.0]
        self._go(steps)

    def creep(self) -> None:
        """Some very short steps."""
        self._go([chance().uniform(*SLOW) for _ in range(chance().randint(*SLOW_STEPS))])

    def _go(self, steps: list[float]) -> None:
        chance().shuffle(steps)
        for length in steps:
            self.step(length)

    def send(self, turtle: Publisher, heard: ReceivedMessages, said_before: float) -> _Leg:
        """Publish what was not yet sent, each pose when the one before was answered: a queue may be of one."""
        first, already, misses = self._sent, len(heard), 0
        for pose in self._poses[first:]:
            before = len(heard)
            turtle.publish(pose)
            if misses < MISSES and not wait(lambda: len(heard) > before, ANSWER_TIMEOUT):  # noqa: B023  (it ends)
                misses += 1
        pause(EXTRA)
        self._sent, jumps, self._jumps = len(self._poses), self._jumps, []
        wanted_before = self._wanted[first - 1] if first else 0.0
        return _Leg(values(heard, "data")[already:], self._wanted[first:], said_before, wanted_before, jumps)


def _along(pose: Pose, theta: float) -> list[tuple[float, float]]:
    return [(pose.x, math.cos(theta)), (pose.y, math.sin(theta))]
