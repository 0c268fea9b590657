"""As many groups of tests that need a processor run at once as there are processors."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from uuid import uuid4

import pytest

from tests.admission import Admission

MOMENT = 0.6  # seconds in which nothing may begin
PATIENCE = 20.0


@pytest.fixture
def workers() -> Iterator[list[Admission]]:
    """One more than there are processors, which all but the last one have."""
    run = uuid4().hex
    several = [Admission(run, {"bound", "other"}) for _ in range((os.cpu_count() or 1) + 1)]
    for one in several[:-1]:
        one.begin("bound")
    yield several
    for one in several:
        one.end()


def begins(worker: Admission, group: str) -> threading.Event:
    """Have a worker begin a group; it is set once that has begun."""
    begun = threading.Event()

    def begin() -> None:
        worker.begin(group)
        begun.set()

    threading.Thread(target=begin, daemon=True).start()
    return begun


@pytest.mark.parametrize("after", ["end", "another group"])
def test_one_too_many_begins_when_another_has_ended(workers: list[Admission], after: str) -> None:
    begun = begins(workers[-1], "other")
    assert not begun.wait(MOMENT)
    if after == "end":
        workers[0].end()
    else:
        workers[0].begin("light")
    assert begun.wait(PATIENCE)


def test_a_group_waits_once(workers: list[Admission]) -> None:
    assert begins(workers[0], "bound").wait(PATIENCE)


def test_a_group_that_needs_no_processor_waits_for_nobody(workers: list[Admission]) -> None:
    assert begins(workers[-1], "light").wait(PATIENCE)
