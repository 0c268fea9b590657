"""As many long groups of tests run at once as there are processors, and more of them while there is room."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from uuid import uuid4

import pytest

from tests import admission
from tests.admission import LONG, Admission

SECONDS = {"short": LONG / 2, **dict.fromkeys(("long", "other"), LONG)}
NEVER = 101.0  # percent that are never free


@pytest.fixture
def workers() -> Iterator[list[Admission]]:
    """One more than there are processors."""
    run = uuid4().hex
    several = [Admission(run, SECONDS) for _ in range((os.cpu_count() or 1) + 1)]
    yield several
    for one in several:
        one.end()


def begin_all(workers: list[Admission]) -> float:
    """Begin a long group in all workers; give the seconds that the last one waits."""
    *first, last = workers
    for one in first:
        one.begin("long")
    began = time.monotonic()
    last.begin("other")
    return time.monotonic() - began


def test_one_too_many_waits(workers: list[Admission], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(admission, "ROOM", NEVER)
    monkeypatch.setattr(admission, "LOOK", 0.05)
    monkeypatch.setattr(admission, "PATIENCE", 0.4)
    assert begin_all(workers) >= 0.4


def test_it_begins_where_there_is_room(workers: list[Admission], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(admission, "ROOM", 0.0)
    monkeypatch.setattr(admission, "LOOK", 0.05)
    assert begin_all(workers) < 20


@pytest.mark.parametrize("after", ["end", "a short group"])
def test_it_begins_when_another_has_ended(
    workers: list[Admission], after: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(admission, "ROOM", NEVER)
    *first, last = workers
    for one in first:
        one.begin("long")
    if after == "end":
        first[0].end()
    else:
        first[0].begin("short")
    began = time.monotonic()
    last.begin("other")
    assert time.monotonic() - began < 20


def test_a_group_waits_once(workers: list[Admission], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(admission, "ROOM", NEVER)
    monkeypatch.setattr(admission, "LOOK", 0.05)
    monkeypatch.setattr(admission, "PATIENCE", 0.4)
    begin_all(workers)
    began = time.monotonic()
    workers[-1].begin("other")
    assert time.monotonic() - began < 0.4


def test_a_short_group_waits_for_nobody(workers: list[Admission], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(admission, "ROOM", NEVER)
    *first, last = workers
    for one in first:
        one.begin("long")
    began = time.monotonic()
    last.begin("short")
    assert time.monotonic() - began < 20
