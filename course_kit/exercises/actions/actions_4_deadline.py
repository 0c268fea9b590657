"""The check of actions-4: an action server that aborts a goal after its time."""

from __future__ import annotations

import time
from dataclasses import dataclass

from example_interfaces.action import Fibonacci

from course_kit.exercises.actions.counting import IN_FLIGHT, TO_STOP, is_ten_a_second, numbers_of, pace_of, result_of
from course_kit.exercises.checker.action_assertions import BusyWork, Client, Goal, expect_action
from course_kit.exercises.checker.assertions import answer, chance, expect, pause, require, wait
from course_kit.exercises.checker.checks import check_of

DEADLINE = 1.0
LATE = 0.5  # seconds that an abort may be late, where the text says 0.3
BUSY = 0.8  # seconds for which the node has something else to do: less than the deadline, more than `LATE`
BY_THE_WAY = 2  # feedbacks between one piece of that and the next
NUMBERS = [0, 1]
while len(NUMBERS) < 47:
    NUMBERS.append(NUMBERS[-1] + NUMBERS[-2])


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
    brought = [result_of(each.goal) or [] for each in (free, busy)]
    expect(
        "the result of the aborted goal has the numbers up to then",
        all(_are_numbers_so_far(*each) for each in zip((free, busy), brought, strict=True)),
        f"The results are {brought[0]} and {brought[1]}, and the last feedback {(numbers_of(free.goal) or [[]])[-1]} "
        f"and {(numbers_of(busy.goal) or [[]])[-1]}: return Fibonacci.Result(sequence=…) after abort(), too.",
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
        """True if it is aborted, after the deadline and not long after."""
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
        if goal.word != "succeeded" or result_of(goal) != NUMBERS[: order + 1]:
            return f"The order {order} is {goal.word}, with {result_of(goal)}"
        told = numbers_of(goal)
        lengths = [len(sequence) for sequence in told]
        grows = bool(told) and lengths == list(range(lengths[0], order + 2)) and lengths[0] <= 3
        if not grows or any(sequence != NUMBERS[: len(sequence)] for sequence in told):
            return f"The feedback of the order {order} is {told}, and not the numbers so far after each number"
    if not is_ten_a_second(client, [*short, long]):
        return f"The feedback comes {pace_of([*short, long]):.2f} s apart, and not 0.1 s"
    return ""


def _are_numbers_so_far(long: Long, brought: list[int]) -> bool:
    last = (numbers_of(long.goal) or [brought])[-1]  # that there is feedback, and that it is right, is another matter
    told = len(last) if len(last) > 1 else len(long.goal.feedback) + 2
    fewest = 2 if long.distracted else 5
    return (
        fewest <= len(brought) <= long.order and told <= len(brought) <= told + 1 and brought == NUMBERS[: len(brought)]
    )
