"""Fixtures of the tests of assertions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import pytest

from course_kit.exercises.catalogue import find
from course_kit.exercises.checker.examination import Examination, begin
from course_kit.exercises.domains import reserve_domain
from course_kit.ros.observing.domain_observer import DomainObserver
from tests.exercises.no_notebook import NoNotebook


@pytest.fixture(scope="session")
def test_domain() -> int:
    """A test domain for the tests of this process: there are few of them, and one is kept until its process ends."""
    return reserve_domain()


@pytest.fixture
def examination(test_domain: int) -> Iterator[Examination]:
    """One that runs, in the test domain and without a notebook: assertions note their findings in it."""
    observer = DomainObserver(test_domain, only_here=True)
    asked = replace(find("services-1"), node_class=None, timeout=60.0)
    made = Examination(asked, observer, observer, {}, NoNotebook())
    begin(made)
    yield made
    begin(None)
    observer.close()
