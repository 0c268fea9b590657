"""The check of services-1: a server that switches a lamp."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from std_srvs.srv import SetBool

from course_kit.exercises.checker.assertions import answer, chance, expect, read, require
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.service_assertions import Client, expect_service, no_answer


@check_of("services-1")
def lamp() -> None:
    """It is switched on and off by whoever asks; each response says whether that changed it, and what it is now."""
    lamps = [_switched(_switches()), _switched([True])]  # the first is left on
    seen = next((one for one in lamps if not one.tells_changes), lamps[0])
    expect(
        "`success` tells whether the request changed the lamp",
        seen.tells_changes,
        f"Asked for {seen.asked} it said {[response.success for response in seen.said]}, and `self.is_on` began as "
        f"{seen.states[0]!r}: each new lamp begins with False. For each request, whoever asks, compare request.data "
        f"with self.is_on before you set it.",
    )
    seen = next((one for one in lamps if not one.tells_states), lamps[0])
    expect(
        "`message` and `self.is_on` tell the state afterwards",
        seen.tells_states,
        f"Asked for {seen.asked} its messages were {', '.join(repr(response.message) for response in seen.said)}, and "
        f"`self.is_on` was {', '.join(map(repr, seen.states[1:]))}: {_why_other_states(seen)}.",
    )


@dataclass
class Switched:
    """What one lamp was asked for, what it said, and its `self.is_on` at first and after each request."""

    data: list[bool]
    said: list[Any]
    states: list[Any]

    @property
    def asked(self) -> str:
        """In words."""
        return ", ".join(map(_word, self.data))

    @property
    def tells_changes(self) -> bool:
        """True if it began as it should, and each `success` is right."""
        changes = [before != after for before, after in pairwise([False, *self.data])]
        return self.states[0] is False and [response.success for response in self.said] == changes

    @property
    def tells_states(self) -> bool:
        """True if each `message` is right, and each `self.is_on`."""
        return [one.message for one in self.said] == [*map(_word, self.data)] and self.states[1:] == self.data


def _why_other_states(seen: Switched) -> str:
    if not all(isinstance(state, bool) for state in seen.states):
        return "self.is_on is True or False"
    if not {response.message for response in seen.said} <= {"on", "off"}:
        return "the message is `on` or `off`, and nothing else in it"
    return "set self.is_on first, then the message"


def _word(is_on: bool) -> str:
    return "on" if is_on else "off"


def _switched(data: list[bool]) -> Switched:
    """Have a new lamp switched by two clients."""
    answer(threads=None)
    clients = [expect_service("/lamp", SetBool), Client("/lamp", SetBool)]
    seen = Switched(data, [], [read("is_on")])
    for wanted in data:
        seen.said.append(chance().choice(clients).ask(data=wanted).response)
        if seen.said[-1] is None:
            break
        seen.states.append(read("is_on"))
    last = f"That was number {len(seen.said)}, for {seen.asked.split(', ')[len(seen.said) - 1]}."
    require("it answers request after request", seen.said[-1] is not None, f"{no_answer('/lamp')} {last}")
    return seen


def _switches() -> list[bool]:
    """What is asked of a lamp that is off, so that it is changed both ways, and left as it is both ways."""
    while True:
        drawn = [*(chance().random() < 0.5 for _ in range(6)), True]
        if len(set(pairwise([False, *drawn]))) == 4:
            return drawn
