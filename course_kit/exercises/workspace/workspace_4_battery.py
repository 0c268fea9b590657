"""The check of workspace-4: a message and a service of the student's own, and a node that uses them."""

from __future__ import annotations

import time
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from course_kit.exercises.checker.assertions import answer, chance, expect, require, wait
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.service_assertions import Client, expect_service
from course_kit.exercises.checker.topic_assertions import expect_topic, listen, rate, values
from course_kit.exercises.checker.workspace_assertions import expect_definition, expect_package, expect_same_types
from course_kit.ros.observing.received_messages import ReceivedMessages

FULL = 100.0
STEPS = 4  # messages from which rate and steps are taken
AFTER = 3  # messages that are looked at after a recharge
EVEN = 1.1  # the largest step, in parts of the smallest, of a battery whose steps are all the same
EXTRA = 0.6  # messages more than seconds, as one may come late before others that do not
UNDER_WAY = 0.4  # seconds after a recharge in which a message may come that is from before it
TRIES = 2  # a busy machine may be late once
NEAR = 0.001  # float32 is not exact


@check_of("workspace-4")
def battery() -> None:
    """The definitions are as asked; the node publishes one and serves the other."""
    expect_package("robot_interfaces", "ament_cmake")
    right = expect_definition("robot_interfaces", "msg/Battery")
    right &= expect_definition("robot_interfaces", "srv/Recharge")
    if not right:
        require("the node can be looked at", False, "Only with these types: put them right, build, restart the kernel.")
    from robot_interfaces.msg import Battery  # the checker's own
    from robot_interfaces.srv import Recharge

    answer(threads=None)
    expect_topic("/battery", Battery)
    client = expect_service("/recharge", Recharge)
    heard = listen("/battery", Battery)
    expect_same_types("/battery", "/recharge")
    wait(lambda: len(heard) >= STEPS, 7.0, "four messages on /battery")
    wait(lambda: _is_steady(heard) or len(heard) >= 3 * STEPS, 8.0, "messages in time")  # for a busy machine
    left = values(heard, "percentage")
    expect(
        "`/battery` comes once a second, each time with less",
        _is_steady(heard) and all(after < before for before, after in pairwise(left) if before > 0.0),
        f"It had {_percent(left)}, {rate(heard):.2f} times a second: a timer with a period of 1.0 s, and less than "
        f"before in `percentage` each time.",
    )
    habit = _Habit.of(heard)
    low, high = chance().randint(20, 60) + 0.9, chance().randint(65, 94) + 0.9  # not what a whole number would be
    just_above, far_above = round(chance().uniform(100.02, 100.5), 2), round(chance().uniform(110, 500), 1)
    asked = [0.0, high, FULL, chance().choice((just_above, far_above))]
    chance().shuffle(asked)
    if [one for one in asked if one <= FULL][-1] == 0.0:  # an empty battery may do what it likes
        asked.append(high)
    other = Client("/recharge", Recharge)
    for _ in range(TRIES):
        count = len(heard)
        wait(lambda: len(heard) > count, 2.0)  # noqa: B023  (it ends); asked just after a message
        why = _fault_of(client, heard, [low, just_above, far_above], habit, AFTER)
        why = why or _fault_of(other, heard, asked, habit, 1)
        if not why:
            break
    expect("`/recharge` sets 0 to 100, and refuses more", not why, why)


@dataclass(frozen=True)
class _Habit:
    """How a battery goes down as long as it is not recharged; what it did wrong then is not counted twice."""

    falls: bool
    is_steady: bool
    reach: float  # per cent that the first message after a recharge may be below what was set
    largest: float  # per cent from one message to the next

    @classmethod
    def of(cls, heard: ReceivedMessages) -> _Habit:
        steps = [before - after for before, after in pairwise(values(heard, "percentage")) if before > 0.0] or [0.0]
        is_even = max(steps) <= EVEN * min(steps)
        return cls(
            falls=min(steps) > 0.0,
            is_steady=_is_steady(heard),
            reach=0.25 + 1.5 * max(steps) if is_even else 1.5 + 3 * max(0.0, *steps),
            largest=max(1.5, *(3 * step for step in steps)),
        )

    def goes_down(self, left: list[float], wanted: float, seconds: float) -> bool:
        """Return True if it goes on from what was set, so many seconds before the first message."""
        reach = self.reach * max(1.0, seconds)
        drops = [before - after for before, after in pairwise(left) if before > 0.0]
        return wanted - reach - NEAR <= left[0] <= wanted + NEAR and all(
            drop <= self.largest + NEAR and (drop > 0.0 or not self.falls) for drop in drops
        )


def _is_steady(heard: ReceivedMessages) -> bool:
    """Return True if the newest messages came once a second."""
    times = heard.times[-STEPS:]
    return len(times) == STEPS and abs((times[-1] - times[0]) / 1e9 / (STEPS - 1) - 1.0) < 0.15


def _fault_of(client: Client, heard: ReceivedMessages, asked: list[float], habit: _Habit, messages: int) -> str:
    """What is wrong with the answers to these percentages, and with what the battery has then, if anything."""
    before = max(0, len(heard) - 1)
    for percentage in asked:
        response = client.ask(percentage=percentage).response
        said = f"To {percentage:g} % it answered {_shortly(response)}."
        if response is None or response.accepted != (percentage <= FULL):
            return f"{said} 0 to 100 are accepted, both included; what is more is not."
        if not response.accepted and not response.reason.strip():
            return f"{said} What is refused has a reason."
    wanted = [one for one in asked if one <= FULL][-1]
    count, asked_at = len(heard), time.time_ns()

    def now() -> list[tuple[float, float]]:
        return [((when - asked_at) / 1e9, float(one.percentage)) for when, one in heard.arrivals[count:]]

    def fits() -> bool:
        came = now()
        parts = [came[first : first + messages] for first in (0, bool(came) and came[0][0] < UNDER_WAY)]
        return any(
            len(part) == messages and habit.goes_down([left for _, left in part], wanted, part[0][0]) for part in parts
        )

    wait(lambda: fits() or len(now()) > messages, messages + 3.0, "the next messages on /battery")
    order = ", ".join(f"{one:g}" for one in asked)
    if not fits():
        return (
            f"After it was asked for {order} % the battery had {_percent([left for _, left in now()])}: it should go "
            f"down from {wanted:g}, in steps as before. What is accepted is set, what is refused is not."
        )
    times = heard.times[before:]
    seconds = (times[-1] - times[0]) / 1e9
    if habit.is_steady and len(times) - 1 > seconds + EXTRA:
        return (
            f"While it was asked for {order} % and after it, {len(times) - 1} messages came on `/battery` in "
            f"{seconds:.1f} s: only the timer publishes."
        )
    return ""


def _percent(values: list[float]) -> str:
    return ", ".join(f"{one:.1f}" for one in values) or "nothing"


def _shortly(response: Any) -> str:
    return f"accepted={response.accepted}, reason={response.reason!r}" if response is not None else "nothing"
