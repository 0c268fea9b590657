"""`ros2 service call` and `action send_goal`: what they print, interrupted and left alone by their servers too."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator

import pytest
import rclpy

from course_kit.base.polling import wait_until
from course_kit.cli.ros2.command import run
from tests.ros2_command import program, ros2
from tests.ros2_running import Running
from tests.waiting import TIMEOUT

pytestmark = pytest.mark.by_turns("a program or a cell for each", of="cases")

INTERRUPTED = 2
ADD, TRIGGER = "example_interfaces/srv/AddTwoInts", "std_srvs/srv/Trigger"
FIBONACCI = "example_interfaces/action/Fibonacci"
UNFIT = "Failed to populate field: "
WAITING = "waiting for service to become available...\n"
LOOKING = "Waiting for an action server to become available...\n"
ACCEPTED = "Goal accepted with ID: ID\n\n"


@pytest.fixture(scope="module", autouse=True)
def world() -> Iterator[None]:
    with program("tests.ros2_transcripts.world"), program("tests.ros2_servers"):
        yield


def without_wait(out: str) -> str:
    """Without the line that is there if the server was not found at once."""
    return out.removeprefix(WAITING)


def without_id(out: str) -> str:
    return re.sub(r"(?<=with ID: )[0-9a-f]{32}", "ID", out)


def request(a: int, b: int) -> str:
    kind = "example_interfaces.srv.AddTwoInts"
    return f"requester: making request: {kind}_Request(a={a}, b={b})\n\nresponse:\n{kind}_Response(sum={a + b})\n\n"


# call ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "printed"),
    [
        (("/add_two_ints", ADD, "{a: 10, b: 5}"), request(10, 5)),
        (("add_two_ints", "example_interfaces/AddTwoInts", "a: -1"), request(-1, 0)),
        (("/add_two_ints", ADD), request(0, 0)),
    ],
)
def test_a_call_prints_request_and_response(words, printed):
    outcome = ros2("service", "call", *words)
    assert (without_wait(outcome.out), outcome.err, outcome.status) == (printed, "", 0)


def test_values_may_come_from_the_standard_input():
    with Running("service", "call", "--stdin", "/add_two_ints", ADD, stdin="a: 1\nb: 2\n") as call:
        assert without_wait(call.end().out) == request(1, 2)


def test_calls_are_repeated_until_an_interrupt():
    with Running("service", "call", "/add_two_ints", ADD, "{a: 1}", "-r", "20") as call:
        call.until("Response(sum=1)", count=5)
        call.interrupt()
        outcome = call.end()
    assert (outcome.err, outcome.status) == ("", INTERRUPTED)
    assert without_wait(outcome.out).startswith(request(1, 0) * 4)


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (("/add_two_ints", "example_interfaces/srv/AddTwoInt"), "The passed service type is invalid"),
        (("/add_two_ints", "std_msgs/msg/String"), "The passed type is not a service"),
        (("/add_two_ints", "AddTwoInts"), "The passed service type is invalid"),
        (("/add_two_ints", ADD, "{a: [1]}"), f"{UNFIT}Value '[1]' is expected to be a dictionary but is a list"),
        (("/add_two_ints", ADD, "5"), f"{UNFIT}Value '5' is expected to be a dictionary but is a int"),
        (
            ("/add_two_ints", ADD, "{a: 99999999999999999999}"),
            f"{UNFIT}The 'a' field must be an integer in [-9223372036854775808, 9223372036854775807]",
        ),
        (
            ("/add_two_ints", ADD, "{a: 1"),
            "The passed value is not valid YAML: while parsing a flow mapping expected ',' or '}', but got "
            "'<stream end>' (line 1, column 6)",
        ),
        (("/add_two_ints", ADD, "-r", "0"), "rate must be greater than zero"),
        (
            ("/add two", ADD),
            "Invalid service name '/add two': it must not contain characters other than alphanumerics, '_', '~', '{', "
            "or '}'",
        ),
    ],
)  # fmt: skip
def test_what_cannot_be_called_is_said_in_a_line(words, error):
    outcome = ros2("service", "call", *words)
    assert (outcome.out, outcome.err.splitlines()[0], outcome.status) == ("", error, 1)
    assert all(line.startswith("Did you mean ") for line in outcome.err.splitlines()[1:])


@pytest.mark.parametrize(
    ("words", "suggestion"),
    [
        (("service", "call", "/add_two_int", ADD), "Did you mean /add_two_ints?\n"),
        (("service", "call", "/add_two_ints", TRIGGER), f"Did you mean {ADD}?\n"),
        (("action", "send_goal", "/fibonaci", FIBONACCI), "Did you mean /fibonacci?\n"),
    ],
)
def test_a_server_that_is_not_there_is_waited_for(words, suggestion):
    with Running(*words) as command:
        command.until(suggestion)
        command.interrupt()
        outcome = command.end()
    assert outcome.out == (WAITING if words[0] == "service" else LOOKING)
    assert (outcome.err, outcome.status) == (suggestion, INTERRUPTED)


def test_a_service_that_never_answers_can_be_interrupted():
    with Running("service", "call", "/silent", TRIGGER) as call:
        call.until("making request: std_srvs.srv.Trigger_Request()\n\n")
        call.interrupt()
        assert call.end(timeout=5).status == INTERRUPTED


def test_a_service_whose_server_ends_is_given_up():
    with program("tests.ros2_servers", "apart"):
        outcome = ros2("service", "call", "/apart/mortal", TRIGGER)
    assert without_wait(outcome.out) == "requester: making request: std_srvs.srv.Trigger_Request()\n\n"
    assert outcome.err == ("Exception while calling service: the server of '/apart/mortal' ended before it answered\n")
    assert outcome.status == 1


# send_goal -------------------------------------------------------------------------------------------------------


def sequence(*numbers: int) -> str:
    return "sequence:\n" + "".join(f"- {n}\n" for n in numbers) + "\n"


@pytest.mark.parametrize(
    ("words", "printed"),
    [
        (
            ("/fibonacci", FIBONACCI, "{order: 3}"),
            f"     order: 3\n\n{ACCEPTED}Result:\n    {sequence(0, 1, 1, 2)}Goal finished with status: SUCCEEDED\n",
        ),
        (
            ("/fibonacci", FIBONACCI, "{order: 3}", "-f"),
            f"     order: 3\n\n{ACCEPTED}Feedback:\n    {sequence(0, 1, 1)}Feedback:\n    {sequence(0, 1, 1, 2)}"
            f"Result:\n    {sequence(0, 1, 1, 2)}Goal finished with status: SUCCEEDED\n",
        ),
        (
            ("fibonacci", "example_interfaces/Fibonacci", "order: -1"),
            f"     order: -1\n\n{ACCEPTED}Result:\n    sequence: []\n\nGoal finished with status: ABORTED\n",
        ),
        (("/refusing", FIBONACCI), "     order: 0\n\nGoal was rejected.\n"),
    ],
)
def test_a_goal_is_followed_to_its_end(words, printed):
    outcome = ros2("action", "send_goal", *words)
    assert without_id(outcome.out) == f"{LOOKING}Sending goal:\n{printed}"
    assert (outcome.err, outcome.status) == ("", 0)


# A terminal's command on a busy machine: the sender loses the processor between sending and noting down.
LATE = """
import sys, time
import rclpy.action.client
from rclpy.task import Future

def late():
    time.sleep(0.05)
    return Future()

rclpy.action.client.Future = late
from course_kit.cli.ros2.command import main
main()
"""


def test_an_answer_that_comes_before_the_goal_is_noted_down_is_not_lost():
    command = [sys.executable, "-c", LATE, "action", "send_goal", "/fibonacci", FIBONACCI, "{order: 2}"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=30)
    assert done.stdout.endswith("Goal finished with status: SUCCEEDED\n")
    assert (done.stderr, done.returncode) == ("", 0)


@pytest.mark.parametrize("times", [1, 2], ids=["once", "twice_at_once"])
def test_an_interrupt_cancels_the_goal(times):
    with Running("action", "send_goal", "/endless", FIBONACCI, "{order: 5}") as goal:
        goal.until("Goal accepted")
        for _ in range(times):
            goal.interrupt()
        outcome = goal.end(timeout=10)
    assert without_id(outcome.out) == (
        f"{LOOKING}Sending goal:\n     order: 5\n\n{ACCEPTED}Canceling goal...\nGoal canceled.\n"
        f"Result:\n    {sequence(7)}Goal finished with status: CANCELED\n"
    )
    assert (outcome.err, outcome.status) == ("", 0)


def test_a_goal_that_takes_its_time_to_be_cancelled_is_waited_for():
    with Running("action", "send_goal", "/slow", FIBONACCI) as goal:
        goal.until("Goal accepted")
        goal.interrupt()
        outcome = goal.end(timeout=20)
    assert outcome.out.endswith(f"Result:\n    {sequence(7)}Goal finished with status: CANCELED\n")
    assert (outcome.err, outcome.status) == ("", 0)


def test_a_goal_that_may_not_be_cancelled_is_left_alone():
    with Running("action", "send_goal", "/stubborn", FIBONACCI) as goal:
        goal.until("Goal accepted")
        goal.interrupt()
        outcome = goal.end(timeout=10)
    assert outcome.out.endswith("\n\nCanceling goal...\n")
    assert (outcome.err, outcome.status) == ("Failed to cancel goal\n", 1)


def test_an_action_whose_server_ends_is_given_up():
    with program("tests.ros2_servers", "apart"):
        outcome = ros2("action", "send_goal", "/apart/mortal_action", FIBONACCI)
    assert without_id(outcome.out) == f"{LOOKING}Sending goal:\n     order: 0\n\n{ACCEPTED}"
    assert outcome.err == "Exception while getting result: the server of '/apart/mortal_action' ended\n"
    assert outcome.status == 1


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (
            ("/fibonacci", FIBONACCI, "{ordr: 5}"),
            "Failed to populate message fields: AttributeError(\"'Fibonacci_Goal' object has no attribute 'ordr'\")",
        ),
        (
            ("/fibonacci", FIBONACCI, "{order: ten}"),
            "Failed to populate message fields: ValueError(\"invalid literal for int() with base 10: 'ten'\")",
        ),
        (("/fibonacci", FIBONACCI, "{order: 'a"), None),
        (("/fibonacci", "example_interfaces/action/Fibonaci", "{}"), "The passed action type is invalid"),
        (("/fibonacci", "std_msgs/msg/String", "{}"), "The passed action type is invalid"),
    ],
)
def test_what_is_no_goal_is_said_in_a_line(words, error):
    outcome = ros2("action", "send_goal", *words)
    first, *more = outcome.err.splitlines()
    assert (outcome.out, outcome.status) == ("", 1)
    assert first == error or (error is None and first.startswith("The passed value is not valid YAML: "))
    assert all(line.startswith("Did you mean ") for line in more)


# In a kernel -------------------------------------------------------------------------------------------------------


def in_kernel(capfd: pytest.CaptureFixture[str], *words: str) -> tuple[str, int]:
    """What a command line prints in a process that goes on, and its exit status."""
    status = run(words)
    return capfd.readouterr().out, status


def test_calls_and_goals_work_again_and_again_in_one_process(capfd):
    for number in range(3):
        out, status = in_kernel(capfd, "service", "call", "/add_two_ints", ADD, f"{{a: {number}}}")
        assert (without_wait(out), status) == (request(number, 0), 0)
        out, status = in_kernel(capfd, "action", "send_goal", "/fibonacci", FIBONACCI, "{order: 2}", "-f")
        assert out.endswith(f"Result:\n    {sequence(0, 1, 1)}Goal finished with status: SUCCEEDED\n")
        assert status == 0
    assert rclpy.ok()


def test_an_interrupt_of_a_cell_cancels_its_goal(capfd):
    handler = signal.getsignal(signal.SIGINT)
    out: list[str] = []

    def is_accepted() -> bool:
        out.append(capfd.readouterr().out)
        return "Goal accepted" in "".join(out)

    def interrupt_when_accepted() -> None:
        wait_until(is_accepted, TIMEOUT)
        signal.raise_signal(signal.SIGINT)

    thread = threading.Thread(target=interrupt_when_accepted)
    thread.start()
    status = run(("action", "send_goal", "/endless", FIBONACCI))
    thread.join()
    text = "".join(out) + capfd.readouterr().out
    assert text.endswith(f"Goal canceled.\nResult:\n    {sequence(7)}Goal finished with status: CANCELED\n")
    assert status == 0
    assert signal.getsignal(signal.SIGINT) is handler
    assert rclpy.ok()
