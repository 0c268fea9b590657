"""As many groups of tests that need a processor run at once as there are processors; one more while they idle."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from itertools import count
from uuid import uuid4

import pytest

from tests import admission
from tests.admission import LOOKS, PROCESSORS, Admission

LOOK = 0.03  # seconds from one look to the next, here
MOMENT = LOOK * LOOKS + 0.5  # seconds in which nothing may begin
PATIENCE = 20.0

Workers = Callable[[Callable[[], float]], list[Admission]]


@pytest.fixture
def workers(monkeypatch: pytest.MonkeyPatch) -> Iterator[Workers]:
    """Make as many as there are processors, each with a group, and two more, which see the processors idle or not."""
    monkeypatch.setattr(admission, "LOOK", LOOK)
    several: list[Admission] = []

    def make(idle: Callable[[], float]) -> list[Admission]:
        run = uuid4().hex
        several.extend(Admission(run, {"bound", "other"}, idle) for _ in range(PROCESSORS + 2))
        for one in several[:-2]:
            one.begin("bound")
        return several

    yield make
    for one in several:
        one.end()


def all_are_busy() -> float:
    """The seconds that busy processors have idled: as many as before."""
    return 0.0


def begins(worker: Admission, group: str) -> threading.Event:
    """Have a worker begin a group; it is set once that has begun."""
    begun = threading.Event()

    def begin() -> None:
        worker.begin(group)
        begun.set()

    threading.Thread(target=begin, daemon=True).start()
    return begun


@pytest.mark.parametrize("after", ["end", "another group"])
def test_one_too_many_begins_when_another_has_ended(workers: Workers, after: str) -> None:
    several = workers(all_are_busy)
    begun = begins(several[-1], "other")
    assert not begun.wait(MOMENT)
    if after == "end":
        several[0].end()
    else:
        several[0].begin("light")
    assert begun.wait(PATIENCE)


def test_a_group_waits_once(workers: Workers) -> None:
    assert begins(workers(all_are_busy)[0], "bound").wait(PATIENCE)


def test_a_group_that_needs_no_processor_waits_for_nobody(workers: Workers) -> None:
    assert begins(workers(all_are_busy)[-1], "light").wait(PATIENCE)


def test_one_more_begins_while_a_processor_idles(workers: Workers) -> None:
    several = workers(time.monotonic)
    assert begins(several[-1], "other").wait(PATIENCE)
    assert not begins(several[-2], "other").wait(MOMENT)


def test_a_processor_that_idled_for_a_moment_lets_no_group_begin(workers: Workers) -> None:
    looks = count()
    several = workers(lambda: LOOK * min(next(looks), LOOKS // 4))
    assert not begins(several[-1], "other").wait(2 * MOMENT)
