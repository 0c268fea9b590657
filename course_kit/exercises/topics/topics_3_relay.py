"""The check of topics-3: a relay from one topic to another."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from rclpy.publisher import Publisher
from turtlesim.msg import Pose

from course_kit.exercises.checker.assertions import answer, chance, expect, nobody_else, pause
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.topic_assertions import (
    expect_compatible_subscription,
    expect_subscription,
    expect_topic,
    is_published,
    listen,
    publisher,
)
from course_kit.robots.turtlesim.field import float32

POSE_RATE = 62.5  # Hz, a turtle's
LATE = 0.06  # seconds from a pose to its relay, of half of them at most
BACKLOG = 0.02  # seconds: a pose that comes out so late has waited, and a queue that is full loses others
BEFORE_THE_NEXT = 0.5  # of the relays at the lower rate; on a busy machine not all
FIELDS = ("x", "y", "theta", "linear_velocity", "angular_velocity")
EQUAL = 30  # poses of a turtle that stands
# Of the rates, in one round after another: a busy machine may need a lower one for a queue of 1 to lose nothing.
PACES = (1.0, 0.6, 0.4)
Timed = list[tuple[int, Pose]]  # when poses were sent or came (nanoseconds), and the poses


@dataclass(frozen=True)
class Relayed:
    """What was sent to a new node, and what came of it."""

    sent: Timed  # no two the same
    fast: int  # how many of them came at a turtle's rate; the others more slowly
    standing: Timed  # sent after them: one pose again and again
    came: Timed

    @property
    def all_sent(self) -> list[Pose]:
        """Every pose that was sent."""
        return [pose for _, pose in self.sent + self.standing]

    @property
    def numbers(self) -> list[int | None]:
        """Which of the poses that were sent came: by one of x, y and theta, as something else may have been changed.

        A pose of the turtle that stands has the number that follows those of the others.
        """
        numbered = list(enumerate([*self.sent, self.standing[0]]))
        places = {field: {getattr(pose, field): n for n, (_, pose) in numbered} for field in ("x", "y", "theta")}
        found = [[places[field].get(getattr(pose, field)) for field in places] for _, pose in self.came]
        return [next((number for number in numbers if number is not None), None) for numbers in found]

    @property
    def arrivals(self) -> list[tuple[int, int]]:
        """The numbers of those that came of the poses that are not the same, and when."""
        pairs = zip(self.numbers, self.came, strict=True)
        return [(n, when) for n, (when, _) in pairs if n is not None and n < len(self.sent)]

    @property
    def moving(self) -> list[int]:
        """These numbers alone."""
        return [number for number, _ in self.arrivals]

    @property
    def steps(self) -> list[int]:
        """How many poses after the one before each of those is."""
        return [after - before for before, after in pairwise(self.moving)]

    @property
    def uneven(self) -> set[int]:
        """The places of those steps that are no ten, from 1; with 0 if none of the first ten poses came."""
        begins_late = {0} if self.moving and self.moving[0] >= 10 else set()
        return begins_late | {place for place, step in enumerate(self.steps, 1) if step != 10}

    @property
    def equal(self) -> int:
        """How many poses of the turtle that stands came."""
        return self.numbers.count(len(self.sent))

    @property
    def delays(self) -> list[float]:
        """Seconds from the sending of each of those poses to its coming."""
        return [(when - self.sent[n][0]) * 1e-9 for n, when in self.arrivals]

    @property
    def unexplained(self) -> int:
        """Of how many uneven places the poses at the ends had not waited in a queue that may have lost some."""
        late = [False, *(delay > BACKLOG for delay in self.delays)]
        return sum(not any(late[place : place + 2]) for place in self.uneven)

    def is_every_tenth(self, lost: int = 0) -> bool:
        """One after nine, but for so many times that a short queue has lost some: then the next comes later."""
        moving, steps = self.moving, self.steps
        if not steps or min(steps) < 10 or abs(self.equal - EQUAL / 10) > 1:
            return False
        others = self.unexplained if lost else len(self.uneven)
        return others <= lost and moving[-1] >= len(self.sent) - 12

    @property
    def is_at_once(self) -> bool:
        """True if poses came soon, and at the lower rate, where there is time for it, before the next was sent."""
        sent = [when for when, _ in self.sent + self.standing]
        slow = [when < sent[n + 1] for n, when in self.arrivals if n >= self.fast]
        return self.usual_delay < LATE and sum(slow) >= BEFORE_THE_NEXT * len(slow)

    @property
    def usual_delay(self) -> float:
        """Half of the poses came in so many seconds at most; 0 if none is known."""
        return sorted(self.delays)[len(self.delays) // 2] if self.delays else 0.0

    @property
    def may_be_disturbed(self) -> bool:
        """True if a busy machine can have caused what is wrong: poses were lost, or came late, but none too early."""
        is_right = self.is_every_tenth() and self.is_at_once
        return not is_right and bool(self.came) and min(self.steps, default=0) >= 10 and self.equal <= EQUAL / 10 + 1


def may_have_lost(rounds: Sequence[Relayed]) -> int:
    """How many times a short queue may have lost poses in the last round: once, where some were lost in each.

    A wrong pattern shows more often, or in each round at the same place.
    """
    return int(len(rounds) == len(PACES) and not set.intersection(*(each.uneven for each in rounds)))


@check_of("topics-3")
def relay() -> None:
    """Of the poses on /turtle1/pose it publishes every tenth, unchanged, on /turtle1/pose_slow, whatever their rate."""
    nobody_else("rt/turtle1/pose", "rt/turtle1/pose_slow")
    turtle = publisher("/turtle1/pose", Pose)
    rounds: list[Relayed] = []
    for pace in PACES:
        relayed = _relayed(turtle, pace)
        rounds.append(relayed)
        if not relayed.may_be_disturbed:
            break
    lost = may_have_lost(rounds)
    expect(
        "what it publishes are poses that it got, unchanged",
        relayed.came and all(pose in relayed.all_sent for _, pose in relayed.came),
        _why_not_got(relayed),
        needed=not relayed.came,
    )
    expect("it is every tenth pose, whatever their rate", relayed.is_every_tenth(lost), _why_not_tenth(relayed))
    sent, came = len(relayed.all_sent), len(relayed.came)
    expect(
        "a tenth of their rate comes out, each at once",
        abs(came - sent / 10) <= 2 + 0.1 * sent / 10 and relayed.is_at_once,
        f"Of {sent} poses {came} came, {relayed.usual_delay:.2f} s after they were sent: publish the tenth pose in its "
        f"own callback, before the next comes. A tenth of 62.5 Hz is 6.25 Hz: `%ros2 topic hz /turtle1/pose_slow` "
        f"measures it.",
    )


def _relayed(turtle: Publisher, pace: float) -> Relayed:
    """What a new node makes of poses at the rate of a turtle, some at a lower one, and those of one that stands.

    The rates are these times `pace`.
    """
    answer(threads=None)
    expect_subscription("/turtle1/pose", Pose)
    expect_compatible_subscription("/turtle1/pose", turtle)
    if not is_published("/turtle1/pose_slow"):  # it may make its publisher when the first poses come
        _send(turtle, POSE_RATE, _some_poses(20))
    expect_topic("/turtle1/pose_slow", Pose)
    slow = listen("/turtle1/pose_slow", Pose)
    pause(0.3)
    before = len(slow)
    rate, lower = pace * POSE_RATE, pace * chance().uniform(16, 25)
    fast = _send(turtle, rate, _some_poses(chance().randint(95, 120)))
    slower = _send(turtle, lower, _some_poses(chance().choice(_few_left(len(fast)))))
    standing = _send(turtle, rate, _some_poses(1) * EQUAL)
    pause(0.4)
    return Relayed(fast + slower, len(fast), standing, slow.arrivals[before:])


def _few_left(fast: int) -> list[int]:
    """For how many slower poses few are left after the last tenth one: whoever skips the equal ones lacks 3 and a part.

    More than that, by the draw alone, would cost the rate its point too.
    """
    return [slower for slower in range(42, 59) if (fast + slower) % 10 <= 6]


def _send(turtle: Publisher, hz: float, poses: list[Pose]) -> Timed:
    """Send poses, never two sooner after one another than their rate says: a queue of 1 is enough for them."""
    sent: Timed = []
    for pose in poses:
        sent.append((time.time_ns(), pose))
        turtle.publish(pose)
        pause(1 / hz)
    return sent


def _some_poses(count: int) -> list[Pose]:
    """Like a turtle's, which may stand; no two the same."""

    def speed() -> float:
        return chance().choice((0.0, chance().uniform(-3.0, 3.0)))

    fields = [
        (chance().uniform(0, 11), chance().uniform(0, 11), chance().uniform(-math.pi, math.pi), speed(), speed())
        for _ in range(count)
    ]
    return [Pose(**dict(zip(FIELDS, map(float32, values), strict=True))) for values in fields]


def _why_not_got(relayed: Relayed) -> str:
    if not relayed.came:
        return "Nothing came on `/turtle1/pose_slow`."
    hint = "Publish the message that the callback was given."
    poses = [*(pose for _, pose in relayed.sent), relayed.standing[0][1]]
    for number, (_, pose) in zip(relayed.numbers, relayed.came, strict=True):
        changed = [] if number is None else [f for f in FIELDS if getattr(pose, f) != getattr(poses[number], f)]
        if changed:
            return f"{', '.join(changed)} of a pose came out otherwise than it went in. {hint}"
    return f"What came out are no poses that went in. {hint}"


def _why_not_tenth(relayed: Relayed) -> str:
    sent, steps, moving = relayed.sent, relayed.steps, relayed.moving
    if steps and relayed.uneven == {0}:
        return f"The first that came was number {moving[0] + 1}: begin with one of the first ten."
    if abs(relayed.equal - EQUAL / 10) > 1 and set(steps) == {10}:
        return f"Of {EQUAL} equal poses {relayed.equal} came: count each message, also one that says the same again."
    return (
        f"Of {len(sent)} poses {len(moving)} came, most of them {sorted(steps)[len(steps) // 2] if steps else 0} after "
        f"the one before, {len(relayed.uneven)} not 10 after it: count the calls of the callback, not the "
        f"time, and publish when the count divides by 10."
    )
