"""Chapter 5's exercises with a server that counts: what each asks, and how it is checked."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from example_interfaces.action import Fibonacci

from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.vocabulary import answer, chance, expect, pause, require, wait
from course_kit.exercises.checker.vocabulary_actions import BusyWork, Client, Goal, expect_action

# Ten numbers a second, on a busy machine too: seconds from one to the next on average, and in the steadiest goal.
FASTEST, SLOWEST = 0.085, 0.125
FEWEST_GAPS = 4  # of a goal that can be the steadiest: with fewer, one late number decides
AGAIN = 3  # goals that are sent where all before may have been late
ORDERS_AGAIN = (7, 8)  # of these: the lower one has FEWEST_GAPS in actions-4, and the higher one ends within a second
TO_STOP = 1.0  # seconds that a cancelled goal may take, where the text says half a second
COUNTED_ON = 6  # numbers, which a busy machine does not make more
IN_FLIGHT = 0.2  # seconds: feedback and result take different ways
DEADLINE = 1.0
LATE = 0.5  # seconds that an abort may be late, where the text says 0.3
BUSY = 0.8  # seconds for which the node has something else to do: less than the deadline, more than `LATE`
BY_THE_WAY = 2  # feedbacks between one piece of that and the next
NUMBERS = [0, 1]
while len(NUMBERS) < 47:
    NUMBERS.append(NUMBERS[-1] + NUMBERS[-2])


def _numbers(goal: Goal) -> list[list[int]]:
    """The sequences of its feedback."""
    return [list(message.sequence) for message in goal.feedback]


def _result(goal: Goal) -> list[int] | None:
    return None if goal.result is None else list(goal.result.sequence)


def _gaps(goal: Goal) -> list[float]:
    """Seconds from feedback to feedback; without the first gap, which a Rate may shorten.

    A Rate or a timer that goes on between the goals has its own beat, in which the first feedback falls anywhere.
    """
    return [(b - a) * 1e-9 for (a, _), (b, _) in list(pairwise(goal.told))[1:]]


def _pace(goals: Sequence[Goal]) -> float:
    """Seconds from feedback to feedback in all of these goals, on average."""
    gaps = [gap for goal in goals for gap in _gaps(goal)]
    return sum(gaps) / len(gaps) if gaps else 0.0


def _is_ten_a_second(client: Client, goals: Sequence[Goal]) -> bool:
    """True where it tells ten numbers a second: no more in all goals, and no less in the steadiest one.

    A busy machine may have made each of them late: then others are sent, three at most.
    """
    if _pace(goals) < FASTEST:
        return False
    tries = list(goals)
    for _ in range(AGAIN):
        if _is_quick_enough(tries):
            break
        tries.append(client.send(order=chance().choice(ORDERS_AGAIN)))
        tries[-1].wait(4.0)
    return _is_quick_enough(tries)


def _is_quick_enough(goals: Sequence[Goal]) -> bool:
    return any(_pace([goal]) < SLOWEST for goal in goals if len(_gaps(goal)) >= FEWEST_GAPS)


@check_of("actions-2")
def countdown_server() -> None:
    """It counts down in its feedback, ten numbers a second, returns them all, rejects and cancels."""
    answer(threads=None)
    clients = [expect_action("/countdown", Fibonacci), Client("/countdown", Fibonacci)]
    orders = [chance().randint(1, 4), 0, chance().randint(5, 8)]
    goals = [clients[0].send(order=orders[0])]
    require(
        f"it accepts the order {orders[0]}",
        goals[0].accepted,
        "It rejected it, or said nothing: goal_callback accepts what is ≥ 0.",
    )
    goals[0].wait(4.0)
    for number in (1, 2):
        goals.append(clients[number % 2].send(order=orders[number]))
        goals[number].wait(4.0)
    too_low = [-1, -chance().randint(2, 2**31)]
    refused = [clients[1].send(order=order) for order in too_low]
    many, enough = chance().randint(50, 90), chance().randint(1, 18)
    long = clients[1].send(order=many)
    wait(lambda: len(long.feedback) >= enough, 4.0, "the feedback of a long goal")
    before = len(long.feedback)
    seconds = long.cancel(2.0)
    if long.word == "canceled":  # else it may still keep the server from another
        orders.append(chance().randint(1, 4))
        goals.append(clients[0].send(order=orders[-1]))
        goals[-1].wait(4.0)
    pause(IN_FLIGHT)
    _expect_countdown(clients[0], orders, goals, many, long)
    accepted = [order for order, goal in zip(too_low, refused, strict=True) if goal.word != "rejected"]
    counted_on = len(long.feedback) - before
    until = (long.settled or math.inf) + IN_FLIGHT * 1e9
    strays = sum(when > until for when, _ in long.told)
    expect(
        "it rejects negative orders and can be cancelled",
        not accepted and long.word == "canceled" and seconds < TO_STOP and counted_on <= COUNTED_ON and not strays,
        f"The order {accepted[0] if accepted else -1} was {'accepted' if accepted else 'rejected'}, and a goal of the "
        f"order {many} that was to be cancelled after {enough} numbers is {long.word} {seconds:.1f} s and {counted_on} "
        f"numbers later, with {strays} feedbacks after that: a goal_callback that returns GoalResponse.REJECT for "
        "orders below 0, a cancel_callback that returns CancelResponse.ACCEPT, and an `execute` that looks at "
        "`is_cancel_requested` for each number.",
    )


def _expect_countdown(client: Client, orders: list[int], goals: list[Goal], many: int, long: Goal) -> None:
    """These goals count down from their orders, and the feedback of a long one from `many`."""
    down = [list(range(order, -1, -1)) for order in orders]
    heard, begun = [*map(_numbers, goals)], _numbers(long)
    wrong = [n for n, wanted in enumerate(down) if heard[n] != [[number] for number in wanted]]
    of_order, came = (orders[wrong[0]], heard[wrong[0]]) if wrong else (many, begun)
    expect(
        "the feedback is `order`, … 0, ten a second",
        not wrong and begun == [[many - n] for n in range(len(begun))] and _is_ten_a_second(client, [*goals, long]),
        f"The feedback of the order {of_order} was {came[:15]}, and all came {_pace([*goals, long]):.2f} s apart: each "
        "is a sequence of one number, every 0.1 s, and after the goal has ended there is none.",
    )
    results = [*map(_result, goals)]
    wrong = [n for n, goal in enumerate(goals) if goal.word != "succeeded" or results[n] != down[n]]
    which = wrong[0] if wrong else 0
    expect(
        "each goal succeeds with its whole sequence",
        not wrong,
        f"The order {orders[which]} is {goals[which].word}, with {results[which]}: `goal_handle.succeed()` sets the "
        "state, without it a goal is aborted, and so it is when `execute` raises. What `execute` returns is the "
        "result, and each goal has a sequence of its own.",
    )


@check_of("actions-4")
def deadline_server() -> None:
    """It counts like CountingServer, and aborts what has taken more than a second by the clock."""
    answer(threads=None)
    client, work = expect_action("/fibonacci_deadline", Fibonacci), BusyWork("/deadline_server")
    orders = chance().sample([chance().randint(2, 4), chance().randint(6, 7)], 2)
    short = [client.send(order=orders[0])]
    short[0].wait(4.0)
    require(
        f"a goal of the order {orders[0]} ends",
        short[0].status is not None,
        f"It is {short[0].word} after 4 s: count as CountingServer does, and look at the time on the way.",
    )
    free, busy = _best_of_three(client), _best_of_three(client, work)
    short.append(client.send(order=orders[1]))
    short[1].wait(4.0)
    unwanted, enough = client.send(order=9), chance().randint(1, 4)
    wait(lambda: len(unwanted.feedback) >= enough, 2.0, "feedback")
    seconds = unwanted.cancel(2.0)
    pause(IN_FLIGHT)
    is_cancelled = unwanted.word == "canceled" and seconds < TO_STOP
    unlike = _unlike_counting_server(client, orders, short, free.goal)
    expect(
        "it counts like CountingServer, and can be cancelled",
        not unlike and is_cancelled,
        f"{unlike}: count as CountingServer does, and look at the time on the way."
        if unlike
        else f"A goal that was to be cancelled after {enough} feedbacks is {unwanted.word} {seconds:.1f} s later: a "
        "cancel_callback that returns CancelResponse.ACCEPT, and an `execute` that looks at `is_cancel_requested`.",
    )
    which = busy if free.is_in_time else free
    expect(
        "what has taken more than a second is aborted",
        free.is_in_time and busy.is_in_time,
        f"{which}: `goal_handle.abort()` when the time since execute() began is over 1 s. A count of numbers is no "
        "clock: it stands still while the node has something else to do.",
    )
    brought = [_result(each.goal) or [] for each in (free, busy)]
    expect(
        "the result of the aborted goal has the numbers up to then",
        all(_are_numbers_so_far(*each) for each in zip((free, busy), brought, strict=True)),
        f"The results are {brought[0]} and {brought[1]}, and the last feedback {(_numbers(free.goal) or [[]])[-1]} and "
        f"{(_numbers(busy.goal) or [[]])[-1]}: return Fibonacci.Result(sequence=…) after abort(), too.",
    )


@dataclass
class Long:
    """A goal that takes more than the deadline."""

    order: int
    goal: Goal
    distracted: float = 0.0  # seconds for which the node had something else to do
    free_again: float = 0.0  # when that was over
    counted_on: int = 0  # feedback meanwhile

    @property
    def seconds(self) -> float:
        """How long it took."""
        return (self.goal.ended or time.monotonic()) - self.goal.sent

    @property
    def late(self) -> float:
        """Seconds from when it could be aborted until it was."""
        return self.goal.sent + self.seconds - max(self.goal.sent + DEADLINE, self.free_again)

    @property
    def is_in_time(self) -> bool:
        """Whether it is aborted, after the deadline and not long after."""
        return self.goal.word == "aborted" and self.seconds > DEADLINE - 0.05 and self.late < LATE

    def __str__(self) -> str:
        when = f" after {self.seconds:.1f} s" if self.goal.accepted else ""
        why = f", of which its node had something else to do for {self.distracted:.1f} s" if self.distracted else ""
        return f"The order {self.order} is {self.goal.word}{when}{why}"


def _best_of_three(client: Client, work: BusyWork | None = None) -> Long:
    """A long goal, perhaps beside other work; the next one only if this was late, as on a busy machine it may be.

    Or if the work did not keep the node from counting: then a count of numbers is as good as a clock.
    """
    tries: list[Long] = []
    for _ in range(3):
        tries.append(long := _run_out(client, work))
        if long.goal.word != "aborted" or (long.late < LATE and long.counted_on <= BY_THE_WAY):
            return long
    kept_busy = [long for long in tries if long.counted_on <= BY_THE_WAY]
    return min(kept_busy or tries, key=lambda long: long.late)


def _run_out(client: Client, work: BusyWork | None) -> Long:
    order = chance().randint(30, 60)
    long = Long(order, client.send(order=order))
    if work is not None and wait(lambda: long.goal.feedback, 1.0, "feedback"):
        began, counted = time.monotonic(), len(long.goal.feedback)
        work.take(BUSY)
        long.free_again = time.monotonic()
        long.distracted = long.free_again - began
        long.counted_on = len(long.goal.feedback) - counted
    long.goal.wait(3.0)
    return long


def _unlike_counting_server(client: Client, orders: list[int], short: list[Goal], long: Goal) -> str:
    """What of these goals is not as CountingServer does it; nothing if all is."""
    for order, goal in zip(orders, short, strict=True):
        if goal.word != "succeeded" or _result(goal) != NUMBERS[: order + 1]:
            return f"The order {order} is {goal.word}, with {_result(goal)}"
        told = _numbers(goal)
        lengths = [len(sequence) for sequence in told]
        grows = bool(told) and lengths == list(range(lengths[0], order + 2)) and lengths[0] <= 3
        if not grows or any(sequence != NUMBERS[: len(sequence)] for sequence in told):
            return f"The feedback of the order {order} is {told}, and not the numbers so far after each number"
    if not _is_ten_a_second(client, [*short, long]):
        return f"The feedback comes {_pace([*short, long]):.2f} s apart, and not 0.1 s"
    return ""


def _are_numbers_so_far(long: Long, brought: list[int]) -> bool:
    last = (_numbers(long.goal) or [brought])[-1]  # that there is feedback, and that it is right, is another matter
    told = len(last) if len(last) > 1 else len(long.goal.feedback) + 2
    fewest = 2 if long.distracted else 5
    return (
        fewest <= len(brought) <= long.order and told <= len(brought) <= told + 1 and brought == NUMBERS[: len(brought)]
    )
