"""An action client meets its server before it sends a goal: the server need know nothing of it, and may be busy."""

from __future__ import annotations

from typing import Any

from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer, GoalResponse
from rclpy.node import Node

from course_kit.background.running import running
from course_kit.calls.meeting import meet_server
from course_kit.polling import wait_until
from course_kit.spinning.nodes import quiet_node
from tests.waiting import wait_until as wait_for


class Server(Node):
    """Notes the goals that it is asked to take, and takes none."""

    def __init__(self) -> None:
        super().__init__("server")
        self.asked: list[Any] = []
        ActionServer(self, Fibonacci, "count", lambda _: Fibonacci.Result(), goal_callback=self.refuse)

    def refuse(self, goal: Any) -> GoalResponse:
        self.asked.append(goal)
        return GoalResponse.REJECT


class Asking(Node):
    def __init__(self) -> None:
        super().__init__("asking")
        self.client = ActionClient(self, Fibonacci, "count")


def test_a_server_that_is_met_is_asked_to_take_no_goal_and_answers_the_next_one():
    with running(Server, Asking) as (server, asking):
        wait_for(asking.client.server_is_ready)
        assert meet_server(asking.client, wait_until)
        assert server.asked == []
        answer = asking.client.send_goal_async(Fibonacci.Goal(order=3))
        wait_for(answer.done)
        assert not answer.result().accepted
        assert len(server.asked) == 1


def test_a_server_that_answers_nothing_counts_as_busy():
    with running(Asking) as asking:
        busy = quiet_node("busy", asking.context)  # nobody spins it
        server = ActionServer(busy, Fibonacci, "count", lambda _: Fibonacci.Result())
        wait_for(asking.client.server_is_ready)
        assert not meet_server(asking.client, wait_until)
        server.destroy()
        busy.destroy_node()
