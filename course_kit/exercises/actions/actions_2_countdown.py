"""The check of actions-2: an action server that counts down."""

from __future__ import annotations

import math

from example_interfaces.action import Fibonacci

from course_kit.exercises.actions.counting import IN_FLIGHT, TO_STOP, is_ten_a_second, numbers_of, pace_of, result_of
from course_kit.exercises.checker.action_assertions import Client, Goal, expect_action
from course_kit.exercises.checker.assertions import answer, chance, expect, pause, require, wait
from course_kit.exercises.checker.checks import check_of

COUNTED_ON = 6  # numbers, which a busy machine does not make more


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
    heard, begun = [*map(numbers_of, goals)], numbers_of(long)
    wrong = [n for n, wanted in enumerate(down) if heard[n] != [[number] for number in wanted]]
    of_order, came = (orders[wrong[0]], heard[wrong[0]]) if wrong else (many, begun)
    expect(
        "the feedback is `order`, … 0, ten a second",
        not wrong and begun == [[many - n] for n in range(len(begun))] and is_ten_a_second(client, [*goals, long]),
        f"The feedback of the order {of_order} was {came[:15]}, and all came {pace_of([*goals, long]):.2f} s apart: "
        "each is a sequence of one number, every 0.1 s, and after the goal has ended there is none.",
    )
    results = [*map(result_of, goals)]
    wrong = [n for n, goal in enumerate(goals) if goal.word != "succeeded" or results[n] != down[n]]
    which = wrong[0] if wrong else 0
    expect(
        "each goal succeeds with its whole sequence",
        not wrong,
        f"The order {orders[which]} is {goals[which].word}, with {results[which]}: `goal_handle.succeed()` sets the "
        "state, without it a goal is aborted, and so it is when `execute` raises. What `execute` returns is the "
        "result, and each goal has a sequence of its own.",
    )
