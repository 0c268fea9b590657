"""The check of services-3: a server that calls another server."""

from __future__ import annotations

from example_interfaces.srv import AddTwoInts

from course_kit.exercises.checker.assertions import answer, chance, expect, require
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.service_assertions import (
    Adder,
    Client,
    Server,
    a_server,
    expect_service,
    no_answer,
    wait_for_answers,
)
from course_kit.exercises.services.sums import draw_numbers, sum_of, written

LARGEST = 10**18  # three times the sum of two such numbers is an int64


@check_of("services-3")
def add_three_times() -> None:
    """It answers 3 · (a + b), asks /add_two_ints three times for that, and adds nothing itself."""
    adder = Adder()
    server = a_server("/add_two_ints", AddTwoInts, adder)
    answer()
    clients = [expect_service("/add_three_times", AddTwoInts), Client("/add_three_times", AddTwoInts)]
    small, others = draw_numbers(99), [_large_numbers(), draw_numbers(99)]
    first = {"a": (one := chance().randint(1, 99)), "b": -one}  # 0, which who does not answer answers too
    asked = [*chance().sample([first, small], 2), *chance().sample(others, 2)]
    came, counts = [], []
    for request, client in zip(asked[:2], clients, strict=True):
        before = len(server.requests)
        came.append(client.ask(**request))
        counts.append(len(server.requests) - before)
        if came[-1].response is None:
            break
    require(
        "it answers",
        came[-1].response is not None,
        f"{no_answer('/add_three_times')} A callback that waits for an answer is a deadlock: make it `async def`, "
        f"await call_async(), and give the client a callback group of its own.",
    )
    before, server.delay = len(server.requests), chance().uniform(0.03, 0.06)
    at_once = [client.send(**request) for request, client in zip(asked[2:], clients, strict=True)]
    came += wait_for_answers(5.0, *at_once)
    counts.append(len(server.requests) - before)
    sums, wanted = [sum_of(each) for each in came], [3 * (each["a"] + each["b"]) for each in asked]
    expect(
        "it answers 3 · (a + b), for one after the other and for two clients at once",
        sums == wanted,
        f"Asked one after the other for {written(asked[:2])} it answered {sums[:2]}, and asked by two clients at once "
        f"for {written(asked[2:])} it answered {sums[2:]}, in place of {wanted}: 3 · (a + b), for each request anew. "
        f"What belongs to one request stays in local variables.",
    )
    expect(
        "it asks /add_two_ints three times for each request",
        counts == [3, 3, 6],
        f"It asked {counts[0]} times for one request, {counts[1]} times for the next, and {counts[2]} times for two at "
        f"once: a + b, then that twice, then the two together.",
    )
    _check_that_it_only_passes_on(adder, server, chance().choice(clients), small)


def _check_that_it_only_passes_on(adder: Adder, server: Server, client: Client, request: dict[str, int]) -> None:
    """The server now adds wrong, by which one sees who has added; the request is one that it knows."""
    wrong = [one for one in range(1, 10) if sum(request.values()) + one]  # a first sum of 0 shows no addition
    server.delay, adder.too_much = 0.0, chance().choice(wrong)
    before = len(server.responses)
    brought = sum_of(client.ask(**request))
    told = [response.sum for response in server.responses[before:]]
    sent = [(each.a, each.b) for each in server.requests[before:]]
    known = [{*request.values(), *told[:number]} for number in range(len(sent))]
    expect(
        "what it answers is the last thing it was told: it adds nothing itself",
        told and brought == told[-1] and all({*pair} <= numbers for pair, numbers in zip(sent, known, strict=True)),
        f"Asked for {written([request])} it sent {sent} to an /add_two_ints that adds {adder.too_much} too much and "
        f"told it {told}, and it answered {brought}: let the server add the sums, too, for each request anew, and "
        f"answer the last one.",
    )


def _large_numbers() -> dict[str, int]:
    """Two large numbers; in floats they, their sum or its threefold become others, also where errors cancel out."""
    while True:
        request = draw_numbers(LARGEST)
        total = sum(request.values())
        rounded = sum(int(float(each)) for each in request.values())
        if total not in (rounded, int(float(total))) and int(3.0 * total) != 3 * total:
            return request
