"""A client meets its server before it asks it for something. The server need know nothing of it, and may be busy."""

from __future__ import annotations

import time
from argparse import Namespace
from functools import partial
from typing import Any

import pytest
from example_interfaces.action import Fibonacci
from rcl_interfaces.srv import GetParameters
from rclpy.action import ActionClient, ActionServer, GoalResponse
from rclpy.node import Node
from rclpy.task import Future
from std_srvs.srv import Trigger

from course_kit.base.polling import wait_until
from course_kit.cli.ros2.servers import outcome
from course_kit.cli.ros2.session import Session
from course_kit.cli.ros2.verbs import CommandError
from course_kit.lab.background.running import running
from course_kit.ros.spinning.nodes import quiet_node
from course_kit.ros.subscriptions import observer_node
from course_kit.ros.subscriptions.clients import PERIOD, call, meet_server, meet_service
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


class Triggered(Node):
    """Counts the requests for its service."""

    def __init__(self, name: str = "triggered", has_parameters: bool = True) -> None:
        super().__init__(name, start_parameter_services=has_parameters)
        self.count = 0
        self.create_service(Trigger, "trigger", self.answer)

    def answer(self, request: Any, response: Any) -> Any:
        self.count += 1
        return response


class Silent(Triggered):
    def __init__(self) -> None:
        super().__init__("silent", has_parameters=False)


class Calling(Node):
    def __init__(self) -> None:
        super().__init__("calling")
        self.client = self.create_client(Trigger, "trigger")


def test_a_service_that_is_met_is_not_called_and_answers_the_next_request():
    with running(Triggered, Calling) as (server, calling):
        wait_for(calling.client.service_is_ready)
        wait_for(lambda: meet_service(calling, calling.client, wait_until))  # the graph knows its node a moment later
        assert server.count == 0
        answer = calling.client.call_async(Trigger.Request())
        wait_for(answer.done)
        assert server.count == 1
        wait_for(lambda: len(list(calling.clients)) == 1)


class Known(Node):
    """Notes the requests for its parameters and for its service, in their order."""

    def __init__(self) -> None:
        super().__init__("known", start_parameter_services=False)
        self.asked: list[str] = []
        self.create_service(GetParameters, "known/get_parameters", partial(self.answer, "parameters"))
        self.create_service(Trigger, "trigger", partial(self.answer, "trigger"))

    def answer(self, what: str, request: Any, response: Any) -> Any:
        self.asked.append(what)
        return response


def test_a_call_meets_the_service_and_asks_it_once():
    with running(Known) as server:
        wait_for(lambda: observer_node.node().count_services("/trigger"))
        assert call(Trigger, "/trigger", Trigger.Request(), 5.0, 10.0) is not None
        *meetings, last = server.asked
        assert last == "trigger"
        assert set(meetings) == {"parameters"}


def test_a_service_beside_no_parameters_is_not_waited_for():
    with running(Silent, Calling) as (_, calling):
        wait_for(calling.client.service_is_ready)
        began = time.monotonic()
        assert not meet_service(calling, calling.client, wait_until)
        assert time.monotonic() - began < PERIOD


def test_a_service_that_answers_nothing_counts_as_busy():
    with running(Calling) as calling:
        busy = Node("busy", context=calling.context)  # nobody spins it
        busy.create_service(Trigger, "trigger", lambda _, response: response)
        wait_for(calling.client.service_is_ready)
        assert not meet_service(calling, calling.client, wait_until)
        busy.destroy_node()


def test_a_caller_without_time_left_asks_once():
    waits = []

    def until(condition: Any, seconds: float) -> Any:
        waits.append(seconds)
        return wait_until(condition, 10.0 if len(waits) == 1 else 0.0)

    with running(Calling) as calling:
        busy = Node("busy", context=calling.context)  # nobody spins it
        busy.create_service(Trigger, "trigger", lambda _, response: response)
        wait_for(calling.client.service_is_ready)
        assert not meet_service(calling, calling.client, until)
        assert len(waits) == 2  # for the service, and for its answer
        busy.destroy_node()


def test_an_answer_that_does_not_come_ends_a_call_in_a_notebook():
    session = Session(Namespace())
    session.in_notebook = True
    with pytest.raises(CommandError, match=r"no answer within 0\.1 s"):
        outcome(session, Future(), lambda: True, "calling service", "it has gone", timeout=0.1)
    with pytest.raises(CommandError, match="it has gone"):
        outcome(session, Future(), lambda: False, "calling service", "it has gone", timeout=30.0)
