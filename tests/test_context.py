"""Contexts beside the first: how far they reach, and that the environment stays as it is."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
import rclpy
from rclpy.node import Node

from course_kit.ros.observing.domain_observer import DomainObserver
from course_kit.ros.spinning import context
from tests.benchmark.child import Program
from tests.waiting import wait_until

RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"


@pytest.fixture
def domain() -> int:
    context.start()
    return int(os.environ["ROS_DOMAIN_ID"])


@contextmanager
def node_that_reaches(reach: str, domain: int) -> Iterator[Node]:
    made = context.separate(domain, reach)
    node = Node("apart", context=made)
    yield node
    node.destroy_node()
    made.try_shutdown()


def test_a_context_reaches_as_far_as_told_whatever_the_environment_says(domain, monkeypatch):
    with Program("idle_node", domain=domain) as idle:
        idle.report()
        monkeypatch.setenv("ROS_LOCALHOST_ONLY", "1")
        monkeypatch.setenv(RANGE, "LOCALHOST")
        with node_that_reaches("OFF", domain) as deaf:
            monkeypatch.delenv("ROS_LOCALHOST_ONLY")
            monkeypatch.setenv(RANGE, "OFF")
            with node_that_reaches("LOCALHOST", domain) as hearing:
                wait_until(lambda: "idle" in hearing.get_node_names())
            assert "idle" not in deaf.get_node_names()


def test_the_environment_stays_as_it_is_while_a_context_is_made(domain, monkeypatch):
    """Other threads start programs meanwhile, in this environment."""
    monkeypatch.setenv(RANGE, "SUBNET")
    seen = []

    class Domain(int):
        def __lt__(self, other: int) -> bool:  # rclpy.init() looks whether it is negative
            seen.append(os.environ.get(RANGE))
            return super().__lt__(other)

    DomainObserver(Domain(domain), only_here=True).close()
    assert seen == ["SUBNET"]


def test_a_thread_that_ends_with_ros_may_use_it_to_the_last():
    """As a live view does: it asks for ROS once more for its last picture, while what stops ROS waits for it."""
    begun = context.start()
    is_asked = threading.Event()
    last: list[int] = []
    thread = threading.Thread(target=lambda: (is_asked.wait(10.0), last.append(context.start())), daemon=True)
    thread.start()

    def closer() -> None:
        is_asked.set()
        thread.join(10.0)
        assert not thread.is_alive()
        closed.append(True)

    closed: list[bool] = []
    context.before_stop(closer)
    context.stop()
    context.ended(closer)
    assert (closed, last, rclpy.ok()) == ([True], [begun], False)
