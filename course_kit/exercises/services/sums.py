"""Numbers to be added, and their sums, as the checks of chapter 4 draw and compare them."""

from __future__ import annotations

from course_kit.exercises.checker.assertions import chance
from course_kit.exercises.checker.service_assertions import Answer


def draw_numbers(largest: int) -> dict[str, int]:
    """Draw the two numbers of a request; one of them at least is negative."""
    a, b = chance().randint(-largest, -1), chance().randint(-largest, largest)
    return {"a": a, "b": b} if chance().random() < 0.5 else {"a": b, "b": a}


def sum_of(answered: Answer) -> int | None:
    """Return the sum in a response; None without one."""
    return None if answered.response is None else int(answered.response.sum)


def written(requests: list[dict[str, int]]) -> str:
    """Return requests as a hint shows them."""
    return ", ".join(f"{each['a']} + {each['b']}" for each in requests)
