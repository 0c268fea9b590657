"""The check of actions-3: an action client that cancels its goal."""

from __future__ import annotations

from functools import partial
from typing import Any

from course_kit.exercises.checker.action_assertions import STATUSES, FibonacciServer
from course_kit.exercises.checker.assertions import answer, chance, expect, pause, wait, wait_for_attribute
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.service_assertions import ANSWER_TIMEOUT

HESITATION = 0.6  # seconds from the fifth feedback to the request to cancel, where the text says half a second


@check_of("actions-3")
def impatient() -> None:
    """It orders 40, cancels after five feedbacks, and keeps the status: of a server that obeys, and of another."""
    server = FibonacciServer()
    pause(0.3)
    # Whoever goes by time is wrong in one of them: the one fifth feedback comes when it is too late for the other.
    rests = chance().sample([(0, 0.0), (chance().randint(1, 4), chance().uniform(1.3, 1.6))], 2)
    orders, after, hesitated, ends, statuses, is_early = [], [], [], [], [], False
    for rest, refuses in zip(rests, chance().sample([False, True], 2), strict=True):
        server.begin(chance().uniform(0.04, 0.08), rest, patient_after=5, refuses=refuses)
        answer(threads=None)
        wait(lambda: server.orders, ANSWER_TIMEOUT, "a goal for /fibonacci")
        if refuses and wait(lambda: server.cancelled_after is not None or server.ended, 5.0, "a request to cancel"):
            early = wait_for_attribute("status", partial(_is_status, "succeeded"), timeout=0.5, needed=False)
            is_early = _is_status("succeeded", early) and not server.ended
        server.go_on()
        wait(lambda: server.ended, 8.0 if server.orders else 0.0, "the end of the goal")
        ends.append(server.ended[0] if server.ended else "executing")
        statuses.append(wait_for_attribute("status", partial(_is_status, ends[-1]), timeout=1.0, needed=False))
        pause(0.2)
        orders.append(list(server.orders))
        after.append(server.cancelled_after)
        hesitated.append(server.hesitated)
        if not server.orders:
            break
    other = [each for each in orders if each != [40]]
    expect(
        "it sends the order 40, once",
        not other,
        f"The orders that came: {other[0] if other else []}. Send one goal, when the node is made, to `fibonacci`, and "
        "wait for the server with a timeout; `%ros2 action info /fibonacci` shows its clients.",
        needed=not all(orders),
    )
    asked = [each for each in after if each is not None and each != 5]
    expect(
        "it cancels after five feedbacks",
        after == [5, 5] and min(hesitated) < HESITATION,
        f"It asked to cancel after {asked[0]} feedbacks: count them in the feedback callback."
        if asked
        else f"It asked to cancel {min(hesitated):.1f} s after the fifth: do it in the feedback callback."
        if None not in after
        else "No request to cancel came: `goal_handle.cancel_goal_async()` in the feedback callback.",
    )
    seen = "; ".join(f"`self.status` is {status!r}, the goal {end}" for status, end in zip(statuses, ends, strict=True))
    expect(
        "`self.status` is 5, canceled, and 4, succeeded, where the server refuses",
        all(map(_is_status, ends, statuses)) and sorted(ends) == ["canceled", "succeeded"] and not is_early,
        f"With two servers, one of which refuses to cancel: {seen}{' and was 4 before its end' if is_early else ''}. "
        "The status comes with the result, "
        "`future.result().status` in the done callback of `get_result_async()`, however the goal ended.",
    )


def _is_status(end: str, value: Any) -> bool:
    return bool(value == STATUSES.index(end))
