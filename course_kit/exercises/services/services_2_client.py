"""The check of services-2: a client that never hangs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from example_interfaces.srv import AddTwoInts

from course_kit.exercises.checker.assertions import (
    answer,
    call,
    chance,
    expect,
    pending_calls,
    wait,
    wait_for_servers,
    wait_for_servers_to_leave,
)
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.service_assertions import Adder, Server, a_server, later

LATE = 0.5  # seconds that it may take longer than its timeout, as the text says
PATIENCE = 4.0  # seconds longer than the timeout after which it counts as hanging
SILENCE = 60.0  # seconds, longer than a check
GIVEN_UP = 0.3  # seconds in which the future of a failed call goes


@dataclass
class Tried:
    """One call of add(a, b, timeout)."""

    a: int
    b: int
    timeout: float
    returned: Any
    seconds: float

    @property
    def is_late(self) -> bool:
        """True if it took longer than it may."""
        return self.seconds > self.timeout + LATE

    def __str__(self) -> str:
        return f"add({self.a}, {self.b}, {self.timeout:.2f}) returned {self.returned!r} after {self.seconds:.1f} s"


@check_of("services-2")
def safe_client() -> None:
    """add() brings the sum, or None in time: without a server, and with one that does not answer, or too late."""
    answer(threads=None)
    adder = Adder()
    server = a_server("/add_two_ints", AddTwoInts, adder)
    wait_for_servers(2.0)  # the request of a client that does not wait for it itself would be lost by chance
    why = _why_no_sum(adder, server)
    expect("with a server it returns the sum", not why, why)
    why = (
        _why_not_safe_from_silence(server)
        or _why_not_safe_from_a_late_answer(adder, server)
        or _why_not_safe_without_a_server(server)
        or _why_not_safe_from_a_late_server(server)
        or _why_not_safe_from_a_server_that_is_back(server)
    )
    expect("without a server or an answer it returns None in time, and leaves no future waiting", not why, why)


def _why_no_sum(adder: Adder, server: Server) -> str:
    """The server answers at once, and then in the last quarter of the timeout; it adds wrong, to see who has added."""
    adder.too_much = chance().randint(1, 9)
    one = chance().randint(-999, 999)
    timeouts = [chance().uniform(2.0, 3.0) for _ in range(2)]
    tried = [_try(*_numbers(), timeouts[0]), _try(one, -one - adder.too_much, timeouts[1])]  # which gives 0
    for timeout, may_raise in ((chance().uniform(1.7, 1.95), True), (2.9, False)):  # a busy machine may be late once
        wait(lambda: len(server.responses) == len(server.requests), timeout, "the server")
        server.delay = 0.75 * timeout
        just_in_time = _try(*_numbers(), timeout, may_raise=may_raise)
        if just_in_time.returned is not None:
            break
    for one_of_them, delay in zip([*tried, just_in_time], (0, 0, server.delay), strict=True):
        if one_of_them.returned != (told := one_of_them.a + one_of_them.b + adder.too_much):
            return (
                f"{one_of_them}. The server, which added {adder.too_much} too much, answered {told} after {delay:.1f} "
                f"s, and got {len(server.requests)} requests in all: wait for the future as long as `timeout` allows, "
                f"then return its result().sum."
            )
    return ""


def _why_not_safe_from_silence(server: Server) -> str:
    asked = _asked_before(server)
    server.delay = SILENCE
    return _why_not_none(_try_in_time(asked), "with a server that did not answer")


def _why_not_safe_from_a_late_answer(adder: Adder, server: Server) -> str:
    """What was not answered is answered while the next call waits."""
    adder.too_much, earlier = 0, {request.a + request.b for request in server.requests}
    later(chance().uniform(0.15, 0.3), server.go_on)
    tried = _try(*_numbers(), 2.5)
    if tried.returned == tried.a + tried.b:
        return ""
    return f"{tried} while the answer to the call before it, which had failed, came late. " + (
        "Each call has a future of its own: take the sum from that one."
        if tried.returned in earlier
        else "Wait for the future of this call as long as `timeout` allows, whatever became of the one before."
    )


def _why_not_safe_without_a_server(server: Server) -> str:
    asked = _asked_before(server)
    server.leave()
    wait_for_servers_to_leave(1.0)
    return _why_not_none(_try_in_time(asked), "without a server")


def _why_not_safe_from_a_late_server(server: Server) -> str:
    """It comes in the middle of the timeout, and answers after its end: too late, but in time for a second timeout."""
    timeout = chance().uniform(0.9, 1.0)
    later(chance().uniform(0.4, 0.45) * timeout, server.come_back)
    server.delay = 0.75 * timeout
    tried = _try(*_numbers(), timeout)
    if tried.returned is None and not tried.is_late:
        return ""
    return (
        f"{tried}, with a server that came in the middle of the timeout and answered after its end: `timeout` is for "
        f"both waits together, so compute what is left of it."
    )


def _why_not_safe_from_a_server_that_is_back(server: Server) -> str:
    server.go_on()
    wait_for_servers(2.0)
    for _ in range(2):  # a busy machine may lose what is sent to a server that has just come
        tried = _try(*_numbers(), 2.5)
        if tried.returned == tried.a + tried.b:
            return ""
    return (
        f"{tried}, with a server that had gone and come back, and answered at once: the next call asks again, whatever "
        f"became of those before."
    )


def _why_not_none(tried: Tried, how: str) -> str:
    wait(lambda: not pending_calls(), GIVEN_UP)
    if tried.returned is not None:
        return (
            f"It returned {tried.returned!r} {how}, and not None: look at what wait_for_service() returns, and catch "
            f"the TimeoutError of wait_for()."
        )
    if tried.is_late:
        return (
            f"With a timeout of {tried.timeout:.2f} s it took {tried.seconds:.1f} s {how}: `timeout` is for both waits "
            f"together, so compute what is left of it."
        )
    if left := pending_calls():
        return (
            f"{left} futures still wait in the client, after a call {how}: "
            f"`self.client.remove_pending_request(future)` after a timeout."
        )
    return ""


def _try(a: int, b: int, timeout: float, may_raise: bool = False) -> Tried:
    returned, seconds = call("add", a, b, timeout, timeout=timeout + PATIENCE, may_raise=may_raise)
    return Tried(a, b, timeout, returned, seconds)


def _try_in_time(numbers: tuple[int, int]) -> Tried:
    """A call that is to fail; a busy machine may be late twice."""
    for _ in range(3):
        tried = _try(*numbers, chance().uniform(0.3, 0.4))
        if not tried.is_late:
            break
    return tried


def _asked_before(server: Server) -> tuple[int, int]:
    """The numbers of a request that was answered: whoever keeps the sums needs no server for them."""
    request = chance().choice(server.requests[: len(server.responses)])
    return request.a, request.b


def _numbers() -> tuple[int, int]:
    return chance().randint(-999, 999), chance().randint(-999, 999)
