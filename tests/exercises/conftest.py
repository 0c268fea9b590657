"""What tests of the checks' vocabulary share."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import pytest

from course_kit.exercises.catalogue import find
from course_kit.exercises.checker.examination import Examination, begin
from course_kit.exercises.domains import reserve_stage
from course_kit.ros.observing.station import Station


@pytest.fixture(scope="session")
def stage_domain() -> int:
    """A stage for the tests of this process: there are few of them, and one is kept until its process ends."""
    return reserve_stage()


@pytest.fixture
def examination(stage_domain: int) -> Iterator[Examination]:
    """One that runs, on the stage and without a notebook: what the vocabulary says is noted in it."""
    station = Station(stage_domain, only_here=True)
    made = Examination(
        replace(find("services-1"), node_class=None, timeout=60.0), station, station, {}, lambda order, timeout: {}
    )
    begin(made)
    yield made
    begin(None)
    station.close()
