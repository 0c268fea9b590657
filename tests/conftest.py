"""Each test process gets a ROS domain of its own, on localhost, with the course's discovery profile."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.domains import own_domain, use_own_domain

SLOW = (  # test modules of more than a minute
    "test_notebooks",
    "test_browser",
    "test_answers",
    "test_faults_robot",
    "test_environment_setup",
)

use_own_domain()


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Where tests run beside each other: those of a module one after another, unless they name a group of their own.

    What takes longest begins, so that the workers end together.
    """
    order = {stem: number for number, stem in enumerate(SLOW)}
    items.sort(key=lambda item: order.get(item.path.stem, len(SLOW)))
    for item in items:
        if item.get_closest_marker("xdist_group") is None:
            item.add_marker(pytest.mark.xdist_group(item.path.stem))


@pytest.fixture(scope="module")
def fresh_domain() -> Iterator[None]:
    """A domain in which no earlier test of this process has left a node, for tests that look at the whole graph."""
    from course_kit.spinning import context

    context.stop()
    with own_domain():
        yield
        context.stop()
