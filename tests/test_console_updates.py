"""The thread that keeps the consoles under cells up to date."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator

import pytest

from course_kit.views.live import console
from tests.waiting import wait_until

AT_ONCE = 8


def updaters() -> int:
    return sum(thread.name == "course_kit consoles" for thread in threading.enumerate())


@pytest.fixture
def many_switches() -> Iterator[None]:
    """Threads that take turns as often as they can."""
    usual = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(usual)


@pytest.mark.usefixtures("many_switches")
def test_threads_that_begin_it_at_once_begin_one() -> None:
    for _ in range(100):
        gate = threading.Barrier(AT_ONCE)

        def begin(gate: threading.Barrier = gate) -> None:
            gate.wait(10.0)
            console._begin_updates()

        threads = [threading.Thread(target=begin) for _ in range(AT_ONCE)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(10.0)
        assert updaters() == 1
        console._end()
        wait_until(lambda: not updaters())
