"""Chapter 5's exercises: what each asks of actions, and how it is checked."""

from __future__ import annotations

import math
import time

from example_interfaces.action import Fibonacci

from course_kit.examining.exercise import exercise
from course_kit.examining.vocabulary import a_turtle, answer, expect, pause, read, require, wait, wait_for_attribute
from course_kit.examining.vocabulary_actions import FibonacciServer, expect_action


@exercise("actions-1", "Face west", points=2, minutes=8, level="warm-up", timeout=20, node_class="FaceWest")
def face_west() -> None:
    """It has the turtle look west, and keeps the last feedback and the result."""
    turtlesim = a_turtle()
    turtle = turtlesim.world.turtles["turtle1"]
    answer()
    began = wait(lambda: turtle.rotation is not None or abs(turtle.theta) > 0.01, 3.0)
    require(
        "the turtle gets a goal",
        began,
        "No goal came on `/turtle1/rotate_absolute`: an ActionClient of the type turtlesim/action/RotateAbsolute, "
        "and `send_goal_async` when the node is made. `%ros2 action info /turtle1/rotate_absolute` shows its clients.",
    )
    wait(lambda: turtle.rotation is None, 8.0, "the end of the turn")
    missing = abs(math.remainder(turtle.theta - math.pi, math.tau))
    expect(
        "it looks west",
        missing < 0.05,
        f"It looks to {math.degrees(turtle.theta):.0f}°: `theta` is in radians, and west is math.pi.",
    )
    delta = wait_for_attribute("delta", lambda value: isinstance(value, float) and value != 0.0, timeout=2.0)
    remaining = read("remaining")
    expect(
        "`self.delta` has the result and `self.remaining` the last feedback",
        isinstance(delta, float)
        and abs(abs(delta) - math.pi) < 0.1
        and isinstance(remaining, float)
        and abs(remaining) < 0.1,
        f"After the turn `self.delta` is {delta!r} and `self.remaining` {remaining!r}: the result comes to the done "
        "callback of `get_result_async()`, as `future.result().result.delta`, and the feedback as "
        "`message.feedback.remaining`.",
    )


@exercise("actions-2", "Count down", points=3, minutes=15, level="medium", timeout=25, node_class="CountdownServer")
def countdown_server() -> None:
    """It counts down in its feedback, ten numbers a second, returns them all, rejects and cancels."""
    answer()
    client = expect_action("/countdown", Fibonacci)
    goal = client.send(order=5)
    require(
        "it accepts the order 5", goal.accepted, "It rejected it, or said nothing: goal_callback accepts what is ≥ 0."
    )
    goal.wait(4.0)
    pause(0.2)  # feedback and result take different ways
    down = list(range(5, -1, -1))
    told = [list(one.sequence) for one in goal.feedback]
    period = goal.period
    expect(
        "the feedback is 5, 4, … 0, ten a second",
        told == [[number] for number in down] and 0.07 < period < 0.14,
        f"The feedback was {told}, {period:.2f} s apart: each is a sequence of one number, every 0.1 s, and after the "
        f"goal has ended there is none.",
    )
    result = list(goal.result.sequence) if goal.result is not None else None
    expect(
        "the goal succeeds with the whole sequence",
        goal.word == "succeeded" and result == down,
        f"It is {goal.word}, with {result}: `goal_handle.succeed()` sets the state, without it a goal is aborted, and "
        "so it is when `execute` raises. What `execute` returns is the result.",
    )
    refused = client.send(order=-1)
    long = client.send(order=60)
    wait(lambda: len(long.feedback) >= 2, 3.0)
    long.cancel(2.0)
    expect(
        "it rejects negative orders and can be cancelled",
        refused.accepted is False and long.word == "canceled",
        f"The order -1 was {'accepted' if refused.accepted else 'rejected'}, and a goal that was to be cancelled is "
        f"{long.word}: a goal_callback that returns GoalResponse.REJECT, a cancel_callback that returns "
        f"CancelResponse.ACCEPT, and an `execute` that looks at `is_cancel_requested`.",
    )


@exercise("actions-3", "Impatience", points=3, minutes=12, level="medium", timeout=20, node_class="Impatient")
def impatient() -> None:
    """It orders 40, cancels after five feedbacks, and keeps how that ended."""
    server = FibonacciServer()
    pause(0.3)
    answer()
    wait(lambda: server.orders, 3.0, "a goal for /fibonacci")
    expect(
        "it sends the order 40",
        server.orders == [40],
        f"The orders that came: {server.orders}. Send one goal, when the node is made, to `fibonacci`; "
        f"`%ros2 action info /fibonacci` shows its clients.",
        needed=not server.orders,
    )
    wait(lambda: server.ended, 6.0, "the end of the goal")
    after = server.cancelled_after
    expect(
        "it cancels after five feedbacks",
        after is not None and 5 <= after <= 8,
        "No request to cancel came: `goal_handle.cancel_goal_async()` in the feedback callback."
        if after is None
        else f"It asked to cancel after {after} feedbacks: count them in the feedback callback.",
    )
    status = wait_for_attribute("status", lambda value: value == 5, timeout=1.0)
    expect(
        "`self.status` is 5, canceled",
        status == 5 and server.ended == ["canceled"],
        f"It is {status!r}, and the goal {server.ended[0] if server.ended else 'still runs'}: the status "
        "comes with the "
        f"result, `future.result().status` in the done callback of `get_result_async()`, also when it was cancelled.",
    )


@exercise(
    "actions-4", "No longer than that", points=3, minutes=15, level="medium", timeout=20, node_class="DeadlineServer"
)
def deadline_server() -> None:
    """It counts Fibonacci's numbers, and aborts what has taken more than a second."""
    answer()
    client = expect_action("/fibonacci_deadline", Fibonacci)
    short = client.send(order=5)
    short.wait(4.0)
    numbers = [0, 1, 1, 2, 3, 5, 8, 13, 21, 34, 55, 89, 144, 233, 377]
    brought = list(short.result.sequence) if short.result is not None else None
    expect(
        "the order 5 succeeds",
        short.word == "succeeded" and brought == numbers[:6],
        f"It is {short.word}, with {brought}: count as CountingServer does, and look at the time on the way.",
        needed=short.status is None,
    )
    sent = time.monotonic()
    long = client.send(order=40)
    long.wait(5.0)
    took = time.monotonic() - sent
    expect(
        "the order 40 is aborted after a second",
        long.word == "aborted" and 0.8 <= took <= 1.7,
        f"It is {long.word} after {took:.1f} s: `goal_handle.abort()` when the time since execute() began is over 1 s.",
    )
    partial = list(long.result.sequence) if long.result is not None else []
    expect(
        "the result of the aborted goal has the numbers up to then",
        5 <= len(partial) <= len(numbers) and partial == numbers[: len(partial)],
        f"It has {partial}: return Fibonacci.Result(sequence=…) after abort(), too.",
    )
