"""Goals put together from status and feedback, and their pictures, from a real action server."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from action_msgs.msg import GoalInfo, GoalStatus, GoalStatusArray
from example_interfaces.action import Fibonacci
from std_msgs.msg import String
from unique_identifier_msgs.msg import UUID

from course_kit.lab.background.waiting import wait_for
from course_kit.lab.calls.goal_plots import plot_goal_states, plot_goals
from course_kit.lab.calls.goals import goals_of
from course_kit.lab.recordings.recording import Recording, record
from tests.counting import FEEDBACK, STATUS, Counting, counting_node


def statuses(**states: int) -> GoalStatusArray:
    """A status message: a goal's name, of one letter, and its state."""
    message = GoalStatusArray()
    for name, status in states.items():
        info = GoalInfo(goal_id=UUID(uuid=list(name.encode().ljust(16, b"\0"))))
        message.status_list.append(GoalStatus(goal_info=info, status=status))
    return message


def test_each_goal_gets_its_changes_of_state():
    messages = [statuses(a=1), statuses(a=2), statuses(a=2, b=1), statuses(a=4, b=3), statuses(a=4, b=5)]
    first, second = goals_of(enumerate(messages))
    assert first.changes == [(0, "ACCEPTED"), (1, "EXECUTING"), (3, "SUCCEEDED")]
    assert second.changes == [(2, "ACCEPTED"), (3, "CANCELING"), (4, "CANCELED")]
    assert (first.ended, second.ended) == (3, 4)


def test_a_goal_that_goes_on_has_no_end():
    (goal,) = goals_of([(0.0, statuses(a=2))])
    assert (goal.state, goal.ended) == ("EXECUTING", None)


def test_goals_that_had_ended_before_are_left_out():
    assert goals_of([(0.0, statuses(a=4)), (1.0, statuses(a=4))]) == []


@pytest.fixture
def counting() -> Iterator[Counting]:
    with counting_node() as node:
        yield node


def order(counting: Counting) -> Recording:
    """Two goals, recorded: one that succeeds and one that is cancelled."""
    with record(STATUS, FEEDBACK) as recording:
        short, long = (wait_for(counting.client.send_goal_async(Fibonacci.Goal(order=n))) for n in (4, 1000))
        wait_for(short.get_result_async())
        wait_for(long.cancel_goal_async())
        wait_for(long.get_result_async())
        ends = {GoalStatus.STATUS_SUCCEEDED, GoalStatus.STATUS_CANCELED}
        wait_for(lambda: {one.status for one in recording[STATUS].messages[-1].status_list} == ends)
    return recording


def texts(plot) -> set[str]:
    return {text.get_text() for axes in plot.axes for text in axes.texts}


def test_the_goals_of_a_server_are_drawn_with_their_ends(counting):
    recording = order(counting)
    plot = plot_goals(recording)
    assert {"SUCCEEDED", "CANCELED"} <= texts(plot)
    assert plot.get_suptitle() == "Goals of /counting"
    assert len(plot.axes[0].lines[0].get_xdata()) == 4, "one mark for each feedback"
    assert re.search(r"Goal 1: ACCEPTED at 0\.00 s, EXECUTING at .*, SUCCEEDED at .* s, 4 times feedback\.", repr(plot))


def test_all_states_are_in_the_state_machine():
    assert {"ACCEPTED", "EXECUTING", "CANCELING", "SUCCEEDED", "CANCELED", "ABORTED"} <= texts(plot_goal_states())


def test_what_is_no_action_is_refused_in_words(counting):
    publisher = counting.create_publisher(String, "words", 10)
    with record("/words") as words:
        publisher.publish(String(data="word"))
    with pytest.raises(ValueError, match="_action/status"):
        plot_goals(words)
    with record(STATUS) as nothing:
        pass
    with pytest.raises(ValueError, match="no goal of /counting was active"):
        plot_goals(nothing)
    with pytest.raises(TypeError, match="record"):
        plot_goals([])
