"""Chapter 2's exercise about types: a message and a service of the student's own, and a node that uses them."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

from course_kit.examining.exercise import exercise
from course_kit.examining.station import Heard
from course_kit.examining.vocabulary import answer, chance, expect, require, wait
from course_kit.examining.vocabulary_services import Client, expect_service
from course_kit.examining.vocabulary_topics import expect_topic, listen, rate, values
from course_kit.examining.vocabulary_workspace import expect_definition, expect_package, expect_same_types

FULL = 100.0
STEPS = 4  # messages from which rate and steps are taken
SHORTEST_REACH = 10.0  # per cent that the first message after a recharge may be below what was set, at least
NEAR = 0.001  # float32 is not exact


@exercise(
    "workspace-4",
    "A battery",
    points=4,
    level="medium",
    timeout=40,
    node_class="Charger",
    file="robot_interfaces/package.xml",
    types=("robot_interfaces",),
)
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
    reach = max([SHORTEST_REACH, *(3 * (before - after) for before, after in pairwise(left))])
    low, high = round(chance().uniform(20, 60), 1), round(chance().uniform(65, 95), 1)
    just_above, far_above = round(chance().uniform(100.02, 100.5), 2), round(chance().uniform(110, 500), 1)
    asked = [0.0, high, FULL, chance().choice((just_above, far_above))]
    chance().shuffle(asked)
    if [one for one in asked if one <= FULL][-1] == 0.0:  # an empty battery may do what it likes
        asked.append(high)
    count = len(heard)
    wait(lambda: len(heard) > count, 2.0)  # asked just after a message, long before the next
    why = _fault_of(client, heard, [low, just_above, far_above], reach)
    why = why or _fault_of(Client("/recharge", Recharge), heard, asked, reach)
    expect("`/recharge` sets 0 to 100, and refuses more", not why, why)


def _is_steady(heard: Heard) -> bool:
    """Whether the newest messages came once a second."""
    times = heard.times[-STEPS:]
    return len(times) == STEPS and abs((times[-1] - times[0]) / 1e9 / (STEPS - 1) - 1.0) < 0.15


def _fault_of(client: Client, heard: Heard, asked: list[float], reach: float) -> str:
    """What is wrong with the answers to these percentages, and with what the battery has then, if anything."""
    for percentage in asked:
        response = client.ask(percentage=percentage).response
        said = f"To {percentage:g} % it answered {_shortly(response)}."
        if response is None or response.accepted != (percentage <= FULL):
            return f"{said} 0 to 100 are accepted, both included; what is more is not."
        if not response.accepted and not response.reason.strip():
            return f"{said} What is refused has a reason."
    wanted = [one for one in asked if one <= FULL][-1]
    count = len(heard)

    def now() -> list[float]:
        return [float(one) for one in values(heard, "percentage")[count : count + 2]]

    def fits() -> bool:
        return any(wanted - reach - NEAR <= one <= wanted + NEAR for one in now())

    wait(lambda: fits() or len(now()) == 2, 4.0, "the next messages on /battery")
    if fits():
        return ""
    order = ", ".join(f"{one:g}" for one in asked)
    return (
        f"After it was asked for {order} % the battery had {_percent(now()) or 'nothing'}: it should go down from "
        f"{wanted:g}. What is accepted is set, what is refused is not."
    )


def _percent(values: list[float]) -> str:
    return ", ".join(f"{one:.1f}" for one in values) or "nothing"


def _shortly(response: Any) -> str:
    return f"accepted={response.accepted}, reason={response.reason!r}" if response is not None else "nothing"
