"""The goals of servers that count, as the checks of actions-2 and actions-4 measure them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from course_kit.exercises.checker.action_assertions import Client, Goal
from course_kit.exercises.checker.assertions import chance

# Ten numbers a second, on a busy machine too: seconds from one to the next on average, and in the steadiest goal.
FASTEST, SLOWEST = 0.085, 0.125
FEWEST_GAPS = 4  # of a goal that can be the steadiest: with fewer, one late number decides
AGAIN = 3  # goals that are sent where all before may have been late
ORDERS_AGAIN = (7, 8)  # of these: the lower one has FEWEST_GAPS in actions-4, and the higher one ends within a second
TO_STOP = 1.0  # seconds that a cancelled goal may take, where the text says half a second
IN_FLIGHT = 0.2  # seconds: feedback and result take different ways


def numbers_of(goal: Goal) -> list[list[int]]:
    """Return the sequences of its feedback."""
    return [list(message.sequence) for message in goal.feedback]


def result_of(goal: Goal) -> list[int] | None:
    """Return the sequence of its result; None without one."""
    return None if goal.result is None else list(goal.result.sequence)


def gaps_of(goal: Goal) -> list[float]:
    """Return the seconds from feedback to feedback; without the first gap, which a Rate may shorten.

    A Rate or a timer that goes on between the goals has its own beat, in which the first feedback falls anywhere.
    """
    return [(b - a) * 1e-9 for (a, _), (b, _) in list(pairwise(goal.told))[1:]]


def pace_of(goals: Sequence[Goal]) -> float:
    """Return the mean of the seconds from feedback to feedback in all of these goals."""
    gaps = [gap for goal in goals for gap in gaps_of(goal)]
    return sum(gaps) / len(gaps) if gaps else 0.0


def is_ten_a_second(client: Client, goals: Sequence[Goal]) -> bool:
    """Return True if it tells ten numbers a second: no more in all goals, and no less in the steadiest one.

    A busy machine may have made each of them late: then others are sent, three at most.
    """
    if pace_of(goals) < FASTEST:
        return False
    tries = list(goals)
    for _ in range(AGAIN):
        if is_quick_enough(tries):
            break
        tries.append(client.send(order=chance().choice(ORDERS_AGAIN)))
        tries[-1].wait(4.0)
    return is_quick_enough(tries)


def is_quick_enough(goals: Sequence[Goal]) -> bool:
    """Return True if the steadiest of these goals is no slower than SLOWEST."""
    return any(pace_of([goal]) < SLOWEST for goal in goals if len(gaps_of(goal)) >= FEWEST_GAPS)
