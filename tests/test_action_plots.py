"""What an action is made of, drawn from the running graph."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.node import Node

from course_kit.lab.recordings.recording import record
from course_kit.ros.graph.action_plots import plot_action
from tests.counting import STATUS, Counting, counting_node

pytestmark = pytest.mark.usefixtures("fresh_domain")
PARTS = {f"/counting/_action/{part}" for part in ("send_goal", "cancel_goal", "get_result", "feedback", "status")}


@pytest.fixture
def counting() -> Iterator[Counting]:
    with counting_node() as node:
        yield node


def names(plot) -> set[str]:
    """The nodes, topics and services that are drawn."""
    return {text.get_text() for text in plot.axes[0].texts if text.get_text().startswith("/")}


def test_an_action_is_three_services_and_two_topics(counting):
    plot = plot_action("counting")
    assert names(plot) == {"/counting", *PARTS}
    assert plot.axes[0].texts[0].get_text() == "1 node, 2 topics, 3 services"


def test_a_client_in_another_node_is_drawn_and_a_recording_is_not(counting):
    asking = Node("asking")
    client = ActionClient(asking, Fibonacci, "counting")
    assert client.wait_for_server(timeout_sec=10.0)
    with record(STATUS):
        assert names(plot_action("/counting")) == {"/counting", "/asking", *PARTS}
    client.destroy()
    asking.destroy_node()


def test_an_action_that_nobody_has_is_refused_with_those_that_there_are(counting):
    with pytest.raises(ValueError, match=r"no node offers or uses an action /cuonting; the actions are: /counting"):
        plot_action("cuonting")
