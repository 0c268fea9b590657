"""The check of topics-1: a countdown from ten, once a subscriber is there."""

from __future__ import annotations

import time

from std_msgs.msg import Int32

from course_kit.exercises.checker.assertions import answer, chance, expect, nobody_else, pause, wait
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.topic_assertions import (
    expect_topic,
    hear_no_longer,
    heard_once_more,
    is_steady,
    listen,
    rate_of,
    values,
)
from course_kit.ros.observing.received_messages import ReceivedMessages

TEN_TO_ZERO = list(range(10, -1, -1))
START_TIMEOUT = 1.5  # seconds from the first match to 10: the second of the text, and half a one for a busy machine
PERIOD_ERROR = 0.2  # of the mean period of a whole count
AFTER_THE_END = 2.5  # seconds for which one of the two counts is listened to when it should be over


@check_of("topics-1")
def count_down() -> None:
    """It publishes 10, 9, … 0, five a second, from when somebody listens, and then no more; a new node does it anew.

    No time that a node could wait for in place of a listener suits both moments.
    """
    nobody_else("rt/countdown")
    moments = [(chance().uniform(0.1, 0.4), len(TEN_TO_ZERO)), (chance().uniform(2.5, 3.2), chance().randint(2, 8))]
    after = [0.7, 0.7]
    after[chance().randrange(2)] = AFTER_THE_END
    counts: list[list[int]] = []
    why = ""
    for moment, seconds in zip(moments, after, strict=True):
        if not why:
            times, why = _one_count(*moment, seconds)
            counts.append(times)
    expect("it counts 10, 9, … 0 from when somebody listens, and stops", not why, why)
    if why:
        del counts[1:]
    # A busy machine may have delayed one count, or single messages of each. A wrong period delays two of two.
    late = [place for place, times in enumerate(counts) if len(times) > 1 and not _is_in_time(times)]
    if len(late) < len(moments):
        for place in late:
            counts[place], _ = _one_count(*moments[place], 0.0)
    if all(map(_is_in_time, counts)) and not any(map(_is_even, counts)):
        counts[0], _ = _one_count(*moments[0], 0.0)
    why = _why_not_five_a_second(counts)
    expect("`/countdown` has 5 messages a second", not why, why)


def _is_in_time(times: list[int]) -> bool:
    return abs(5.0 / rate_of(times) - 1) <= PERIOD_ERROR


def _is_even(times: list[int]) -> bool:
    return is_steady(times, 5.0, within=0.15)


def _why_not_five_a_second(counts: list[list[int]]) -> str:
    """Name the fault in the times (ns) of the counts, if any: a wrong mean period, or none of them even."""
    if all(map(_is_in_time, counts)) and any(map(_is_even, counts)):
        return ""
    worst = max(counts, key=lambda times: abs(rate_of(times) - 5.0))
    best = min(counts, key=lambda times: abs(rate_of(times) - 5.0))
    came = f"It was {rate_of(worst):.1f} Hz." if len(worst) > 1 else "Too few messages came for a rate."
    if all(map(_is_in_time, counts)):
        came = f"It was {rate_of(best):.1f} Hz in all, but the messages came unevenly."
    elif len(counts) > 1 and _is_in_time(best):
        came = f"It was {rate_of(worst):.1f} Hz in one of two counts: each goes on 0.2 s after its last number."
    return f"{came} The period is in seconds: 1 / 5 = 0.2. `%ros2 topic hz /countdown` measures it."


def _one_count(moment: float, again_after: int, after: float) -> tuple[list[int], str]:
    """Listen to a new node after a moment, a second time after so many numbers; when they came, and what is wrong.

    `after`: seconds for which it is listened to after its end. Times in ns, without those of what came after the count.
    """
    answer(threads=None)
    expect_topic("/countdown", Int32)
    pause(moment)  # nobody listens yet, so nothing may be counted
    heard = listen("/countdown", Int32)
    matched = time.time_ns()
    if not wait(lambda: len(heard), timeout=4.0):
        return [], _why_not_ten([])
    _wait_for(heard, again_after, quiet=1.2)
    with heard_once_more("/countdown", Int32) as numbered:
        _wait_for(heard, len(TEN_TO_ZERO), quiet=1.2)
        _wait_for(heard, len(TEN_TO_ZERO) + 3, quiet=after)
    hear_no_longer(heard)
    return heard.times[: len(TEN_TO_ZERO)], _what_is_wrong(heard, matched, numbered)


def _wait_for(heard: ReceivedMessages, count: int, quiet: float) -> None:
    """Until so many have come, or for so many seconds none."""
    began = time.time_ns()
    wait(lambda: len(heard) >= count or time.time_ns() - max([began, *heard.times]) > quiet * 1e9, timeout=6.0)


def _what_is_wrong(heard: ReceivedMessages, matched: int, numbered: list[tuple[int, Int32]]) -> str:
    counted = values(heard, "data")
    if counted != TEN_TO_ZERO:
        return _why_not_ten(counted)
    # Each number says how many were to be sent before it, and the middleware's how many were.
    if too_early := [sent for sent, number in numbered if sent + number.data > 11]:
        return (
            f"{too_early[0]} were sent when the check had heard fewer: nothing is published before somebody listens. "
            f"Publish only when `self.publisher.get_subscription_count()` is more than 0."
        )
    waited = (heard.times[0] - matched) * 1e-9
    if waited > START_TIMEOUT:
        return (
            f"It began {waited:.1f} s after the subscription had matched: wait for the match, that is until "
            f"`self.publisher.get_subscription_count()` is more than 0, and not for a time."
        )
    return ""


def _why_not_ten(counted: list[int]) -> str:
    if not counted:
        return (
            "Nothing came within 4 s. Does its timer wait for `self.publisher.get_subscription_count()`, and then "
            "publish? Begin with 10 in each new node: what is published before a subscription has matched is lost."
        )
    heard = f"ReceivedMessages: {', '.join(map(str, counted[:14]))}."
    if counted == TEN_TO_ZERO[::-1]:
        return f"{heard} It counts up."
    if counted[0] < 10:
        return (
            f"{heard} The first numbers went to nobody: a message that is sent before a subscription has matched is "
            f"lost. Count only when `self.publisher.get_subscription_count()` is more than 0, and each new node anew."
        )
    if counted[: len(TEN_TO_ZERO)] == TEN_TO_ZERO:
        return (
            f"{heard} It goes on after 0, or counts again for who comes later: cancel the timer, or return before it "
            f"publishes."
        )
    return f"{heard} It should be 10, 9, … 0, each once, whoever begins to listen meanwhile."
