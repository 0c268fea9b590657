"""A goal that is sent from a cell, while another thread takes the answer: none is lost."""

from __future__ import annotations

import threading
import time

import pytest
import rclpy.action.client
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node
from rclpy.task import Future

from course_kit import run, stop, wait_for

HELD = 12_345  # the order of a goal that ends when it is released
released = threading.Event()


class Server(Node):
    def __init__(self) -> None:
        super().__init__("guarded_server")
        self.server = ActionServer(self, Fibonacci, "guarded", self.execute)

    async def execute(self, goal_handle) -> Fibonacci.Result:
        if goal_handle.request.order == HELD:
            released.wait(20)
        goal_handle.succeed()
        return Fibonacci.Result(sequence=[goal_handle.request.order])


class Client(Node):
    def __init__(self) -> None:
        super().__init__("guarded_client")
        self.action = ActionClient(self, Fibonacci, "guarded")


@pytest.fixture
def client():
    run(Server)
    client = run(Client)
    assert client.action.wait_for_server(timeout_sec=20.0)
    yield client.action
    stop()


def test_an_answer_that_comes_before_the_request_is_noted_down_is_not_lost(client, monkeypatch):
    def late() -> Future:
        """A future made as on a busy machine: the sender loses the processor between sending and noting down."""
        time.sleep(0.05)
        return Future()

    monkeypatch.setattr(rclpy.action.client, "Future", late)
    for order in range(5):
        handle = wait_for(client.send_goal_async(Fibonacci.Goal(order=order)), timeout=20)
        answer = wait_for(handle.get_result_async(), timeout=20)
        assert list(answer.result.sequence) == [order]


def test_many_goals_in_a_row_are_all_answered(client):
    for order in range(200):
        handle = wait_for(client.send_goal_async(Fibonacci.Goal(order=order)), timeout=20)
        answer = wait_for(handle.get_result_async(), timeout=20)
        assert list(answer.result.sequence) == [order]


def test_a_time_out_says_what_of_which_action_did_not_come(client):
    node = client._node
    nobody = ActionClient(node, Fibonacci, "nobody")
    with pytest.raises(TimeoutError, match=r"the answer to the goal of the action nobody did not .* No node offers"):
        wait_for(nobody.send_goal_async(Fibonacci.Goal()), timeout=0.5)
    handle = wait_for(client.send_goal_async(Fibonacci.Goal(order=HELD)), timeout=20)
    with pytest.raises(TimeoutError, match=r"the result of the action guarded did not come .* a longer timeout"):
        wait_for(handle.get_result_async(), timeout=0.5)
    released.set()
    assert list(wait_for(handle.get_result_async(), timeout=20).result.sequence) == [HELD]
