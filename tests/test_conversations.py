"""The conversation about a goal, from a real action server: what was asked and answered, and its picture."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pytest
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.action.client import ClientGoalHandle

from course_kit.lab.background.waiting import wait_for
from course_kit.lab.calls.conversations import Request, note_requests, plot_conversation
from course_kit.lab.recordings.recording import Recording, record
from tests.counting import FEEDBACK, STATUS, Counting, counting_node


@pytest.fixture
def counting() -> Iterator[Counting]:
    with counting_node() as node:
        yield node


def converse(counting: Counting, order: int, cancels: bool) -> tuple[Recording, list[Request]]:
    """A goal that is recorded to its end, and maybe cancelled."""
    with record(STATUS, FEEDBACK) as told, note_requests() as asked:
        handle = wait_for(counting.client.send_goal_async(Fibonacci.Goal(order=order)))
        result = handle.get_result_async()
        if cancels:
            wait_for(lambda: len(told[FEEDBACK]) >= 2)
            counting.lingers = True  # until the client has the answer: the state lasts from one row to another
            wait_for(handle.cancel_goal_async())
            counting.lingers = False
        status = wait_for(result).status
        wait_for(lambda: told[STATUS].messages[-1].status_list[-1].status == status)
        wait_for(lambda: not any(math.isnan(one.answered) for one in asked))
    return told, asked


def rows(plot) -> list[str]:
    """What stands on the arrows, from top to bottom."""
    return [text.get_text() for text in plot.axes[0].texts if text.get_text() not in ("", "client", "server")]


def states(plot) -> list[str]:
    return [text.get_text() for text in plot.axes[0].get_legend().get_texts()]


def test_requests_are_noted_with_the_moments_of_their_answers(counting):
    _, (goal, result) = converse(counting, 2, cancels=False)
    assert (goal.service, result.service) == ("send_goal", "get_result")
    assert goal.sent <= goal.answered <= result.sent < result.answered
    assert goal.answer.accepted
    assert goal.uuid == result.uuid == bytes(bytearray(goal.answer.goal_id.uuid))


def test_after_the_block_nothing_is_noted_and_rclpy_is_as_it_was(counting):
    methods = ActionClient.send_goal_async, ClientGoalHandle.get_result_async, ClientGoalHandle.cancel_goal_async
    _, asked = converse(counting, 1, cancels=False)
    wait_for(counting.client.send_goal_async(Fibonacci.Goal(order=1)))
    assert len(asked) == 2
    after = ActionClient.send_goal_async, ClientGoalHandle.get_result_async, ClientGoalHandle.cancel_goal_async
    assert after == methods


def test_a_request_without_an_answer_has_no_moment_of_one(counting):
    nobody = ActionClient(counting, Fibonacci, "nobody")
    with note_requests() as asked:
        nobody.send_goal_async(Fibonacci.Goal(order=1))
    nobody.destroy()
    assert math.isnan(asked[0].answered)


def test_each_request_response_and_feedback_is_a_row_in_its_order(counting):
    plot = plot_conversation(*converse(counting, 3, cancels=False))
    said = rows(plot)
    assert said[0] == "send_goal request"
    assert said[-1] == "get_result response: SUCCEEDED"
    assert {"send_goal response: accepted", "get_result request", *(f"feedback {n}" for n in (1, 2, 3))} < set(said)
    assert said.index("get_result request") < said.index("feedback 2")
    told = repr(plot)
    assert told.startswith("A goal of /counting. 0 ms client: send_goal request; ")
    assert " server: send_goal response: accepted; " in told and "Its states: ACCEPTED after " in told
    assert "EXECUTING" in states(plot)
    assert "CANCELING" not in states(plot)


def test_a_cancelled_goal_has_the_request_the_word_and_the_time_in_between(counting):
    plot = plot_conversation(*converse(counting, 1000, cancels=True))
    assert {"cancel_goal request", "cancel_goal response: granted"} < set(rows(plot))
    assert rows(plot)[-1] == "get_result response: CANCELED"
    assert "CANCELING" in states(plot)


def test_of_two_goals_the_first_is_drawn(counting):
    with record(STATUS, FEEDBACK) as told, note_requests() as asked:
        handles = [wait_for(counting.client.send_goal_async(Fibonacci.Goal(order=n))) for n in (2, 5)]
        for handle in handles:
            wait_for(handle.get_result_async())
    said = rows(plot_conversation(told, asked))
    assert said.count("send_goal request") == said.count("get_result request") == 1
    assert not any(row.startswith("feedback 3") for row in said)


def test_what_is_no_conversation_is_refused_in_words(counting):
    with record(STATUS) as nothing:
        pass
    with pytest.raises(ValueError, match="no goal of /counting was active"):
        plot_conversation(nothing, [])
    with pytest.raises(TypeError, match="note_requests"):
        plot_conversation(nothing, None)
    with pytest.raises(TypeError, match="record"):
        plot_conversation([], [])
