"""Chapter 5's exercises: what each asks of actions, and how it is checked."""

from __future__ import annotations

import cmath
import math
import time
from itertools import accumulate, pairwise

from example_interfaces.action import Fibonacci
from turtlesim.msg import Pose

from course_kit.examining import paths
from course_kit.examining.exercise import exercise
from course_kit.examining.station import Heard
from course_kit.examining.vocabulary import a_turtle, answer, expect, pause, read, require, wait, wait_for_attribute
from course_kit.examining.vocabulary_actions import Client, FibonacciServer, expect_action
from course_kit.examining.vocabulary_topics import hear_the_turtle

SIDE = 2.0  # metres of a line of the star
STAR_TURN = 2 * math.tau / 5


@exercise("actions-1", "Face west", points=2, level="warm-up", timeout=20, node_class="FaceWest")
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


@exercise("actions-2", "Count down", points=3, level="medium", timeout=25, node_class="CountdownServer")
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
    numbers = [list(message.sequence) for message in goal.feedback]
    period = goal.period
    expect(
        "the feedback is 5, 4, … 0, ten a second",
        numbers == [[number] for number in down] and 0.07 < period < 0.14,
        f"The feedback was {numbers}, {period:.2f} s apart: each is a sequence of one number, every 0.1 s, and after "
        f"the goal has ended there is none.",
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


@exercise("actions-3", "Impatience", points=3, level="medium", timeout=20, node_class="Impatient")
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


@exercise("actions-4", "No longer than that", points=3, level="medium", timeout=20, node_class="DeadlineServer")
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


@exercise(
    "actions-5",
    "A star, and back home",
    points=5,
    level="project",
    timeout=120,
    node_class="StarServer",
    types=("my_interfaces",),
)
def star_server() -> None:
    """It drives a star, goes back to its beginning when it is cancelled, and lets a second goal win."""
    from my_interfaces.action import Polygon  # the checker's own

    a_turtle()
    driven = hear_the_turtle()
    answer()
    client = expect_action("/drive_star", Polygon)
    pause(0.3)
    start, before = driven.last, len(driven)
    goal = client.send(side_length=SIDE)
    require("it accepts a goal", goal.accepted, "It rejected a line of 2 m, or said nothing.")
    goal.wait(45.0)
    distance = goal.result.distance if goal.result is not None else math.nan
    expect(
        "the goal succeeds, and the result is the metres driven",
        goal.word == "succeeded" and abs(distance - 5 * SIDE) < 1.0,
        f"It is {goal.word}, with a distance of {distance:.1f} m: drive all five lines, then `goal_handle.succeed()`, "
        f"and return a result in which `distance` is {5 * SIDE:g}.",
    )
    poses = driven.messages[before:]
    apart = max(min(paths.nearest_approach(poses, p) for p in pair) for pair in _corners(start))
    turned = abs(paths.length(poses) - 5 * SIDE)
    expect(
        "the path is a star with five points",
        apart < 0.25 and turned < 1.0,
        f"It missed a corner by {apart:.2f} m, and drove {paths.length(poses):.1f} m in place of {5 * SIDE:g}: at each "
        "point of a star the turtle turns by 144°, twice the angle of a pentagon.",
    )
    left = [message.distance_left for message in goal.feedback]
    expect(
        "the feedback is the metres left",
        len(left) > 10 and 4 * SIDE < left[0] <= 5.2 * SIDE and left[-1] < 0.3 and all(_falls(left)),
        f"It began with {left[0] if left else 'nothing'} and ended with {left[-1] if left else 'nothing'}: what is "
        f"left of this line and of the lines after it, {5 * SIDE:g} at the beginning.",
    )
    _check_cancel(client, driven)
    _check_preempt(client)


def _check_cancel(client: Client, driven: Heard) -> None:
    home = driven.last
    goal = client.send(side_length=SIDE)
    wait(lambda: goal.feedback and goal.feedback[-1].distance_left < 3.7 * SIDE, 20.0)
    goal.cancel(20.0)
    away = math.dist((home.x, home.y), (driven.last.x, driven.last.y))
    expect(
        "cancelled, the turtle is back where the star began before the goal is canceled",
        goal.word == "canceled" and away < 0.3,
        f"The goal is {goal.word}, and the turtle {away:.1f} m from there: a cancel_callback that accepts, and "
        f"`goal_handle.canceled()` only after the way back.",
    )


def _check_preempt(client: Client) -> None:
    first = client.send(side_length=SIDE)
    pause(1.0)
    second = client.send(side_length=SIDE)
    first.wait(4.0)
    pause(0.5)
    count = len(second.feedback)
    pause(0.5)
    expect(
        "a second goal takes the place of the first",
        first.word in ("aborted", "canceled") and second.accepted and len(second.feedback) > count,
        f"With a second goal on its way the first is {first.word}, and the second "
        f"{'runs' if len(second.feedback) > count else 'has no feedback'}: abort the first, and let its loop end.",
    )


def _corners(start: Pose) -> list[tuple[paths.Point, paths.Point]]:
    """The corners of a star from a pose, each for both ways round."""
    ways = []
    for sign in (1, -1):
        sides = [cmath.rect(SIDE, start.theta + sign * number * STAR_TURN) for number in range(5)]
        ends = accumulate(sides, initial=complex(start.x, start.y))
        ways.append([(end.real, end.imag) for end in ends][1:])
    return list(zip(*ways, strict=True))


def _falls(left: list[float]) -> list[bool]:
    """For each feedback whether it is not more than the one before, but for the noise of steering."""
    return [after <= before + 0.3 for before, after in pairwise(left)]
