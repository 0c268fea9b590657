"""The check of actions-1: an action client turns a turtle to the west."""

from __future__ import annotations

import math
from typing import Any

from course_kit.exercises.checker.action_assertions import TurtlesRotations
from course_kit.exercises.checker.assertions import (
    a_turtle,
    answer,
    chance,
    expect,
    place_turtle,
    require,
    wait,
    wait_for_attribute,
)
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.service_assertions import ANSWER_TIMEOUT
from course_kit.robots.turtlesim.field import MIDDLE
from course_kit.robots.turtlesim.turtle import ARRIVED, Outcome

LATE_FEEDBACKS = 12  # feedback that may still be on its way when a result comes; rclpy drops it then


@check_of("actions-1")
def face_west() -> None:
    """It has the turtle look west by one goal, and keeps the last feedback and the result."""
    turtlesim = a_turtle()
    rotations = TurtlesRotations(turtlesim)
    side = chance().choice((1, -1))
    far, near = chance().uniform(0.8, 2.2), chance().choice((0.0, *[chance().uniform(0.1, 0.4)] * 3))
    goals, wrong = [], []
    for away in (side * far, -side * near):  # radians from west: from one side of it, then from the other
        place_turtle(turtlesim, MIDDLE, MIDDLE, math.pi - away)
        rotations.begin()
        answer(threads=None)
        require(
            "the turtle gets a goal",
            wait(lambda: rotations.goals, ANSWER_TIMEOUT, "a goal of the turtle's action"),
            "No goal came on `/turtle1/rotate_absolute`: an ActionClient of the type turtlesim/action/RotateAbsolute, "
            "`wait_for_server` with a timeout, and `send_goal_async` when the node is made. `%ros2 action info "
            "/turtle1/rotate_absolute` shows its clients.",
        )
        wait(lambda: rotations.goals[-1].outcome, 8.0, "the end of the turn")
        wrong.append(_not_kept(rotations))
        goals.append(list(rotations.goals))
    rotations.require_one_server()
    asked = ["; ".join(f"{math.degrees(goal.goal):.0f}°" for goal in each) for each in goals]
    expect(
        "one goal has it look west",
        all(len(each) == 1 and each[0].outcome is Outcome.SUCCEEDED and _is_west(each[0].goal) for each in goals),
        f"Your node was made twice. The goals that it sent: {asked[0]}, and {asked[1]}. It sends one when it is made; "
        "`theta` is in radians, and west is math.pi.",
    )
    expect(
        "`self.delta` has the result and `self.remaining` the last feedback",
        not any(wrong),
        f"{wrong[0] or wrong[1]}: the result comes to the done callback of `get_result_async()`, as "
        "`future.result().result.delta`, and the feedback as `message.feedback.remaining`.",
    )


def _is_west(heading: float) -> bool:
    return abs(math.remainder(heading - math.pi, math.tau)) < ARRIVED


def _not_kept(rotations: TurtlesRotations) -> str:
    """What the node does not keep of a rotation that has ended; nothing if it keeps all."""
    turned = rotations.goals[-1].delta

    def is_result(value: Any) -> bool:  # the sign does not matter: the result's is opposite to the turn
        return _is_near(_field(value, "delta"), turned, -turned)

    delta = wait_for_attribute("delta", is_result, timeout=2.0, needed=False)
    if not is_result(delta):
        return f"The result was {turned:.4f} rad, and after the turn `self.delta` is {delta!r}"
    if len(rotations.remaining) <= 3:  # it looked west from the beginning: whether any is heard is chance
        return ""

    def is_last(value: Any) -> bool:
        # Looked up each time: the checker may hear the last ones after the node did.
        return _is_near(_field(value, "remaining"), *rotations.remaining[-LATE_FEEDBACKS:])

    remaining = wait_for_attribute("remaining", is_last, timeout=0.5, needed=False)
    if not is_last(remaining):
        last = f"The last feedback was {rotations.remaining[-1]:.4f} rad"
        return f"{last}, and after the turn `self.remaining` is {remaining!r}"
    return ""


def _field(value: Any, name: str) -> Any:
    """A field, also where the whole message is kept."""
    while isinstance(value, dict):
        value = next((value[each] for each in (name, "feedback", "result") if each in value), None)
    return value


def _is_near(value: Any, *wanted: float) -> bool:
    return isinstance(value, int | float) and any(abs(value - one) < 1e-4 for one in wanted)
