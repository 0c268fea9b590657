"""`ros2 service echo`: the four moments of each call, once client and server report them; switched on by parameters."""

from __future__ import annotations

import csv
import re
import signal
from collections.abc import Iterator
from typing import Any

import pytest
import yaml
from example_interfaces.srv import AddTwoInts
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.service_introspection import ServiceIntrospectionState
from service_msgs.msg import ServiceEventInfo
from std_srvs.srv import Trigger

from course_kit.lab.background.running import running
from tests.ros2_command import ros2
from tests.ros2_running import Running
from tests.waiting import wait_until

STATES = {
    "disabled": ServiceIntrospectionState.OFF,
    "metadata": ServiceIntrospectionState.METADATA,
    "contents": ServiceIntrospectionState.CONTENTS,
}
MOMENTS = ["REQUEST_SENT", "REQUEST_RECEIVED", "RESPONSE_SENT", "RESPONSE_RECEIVED"]
A_NUMBER = re.compile(r"(?<=: )\d+$", re.MULTILINE)


class Reporting(Node):
    """A node whose client or server, its `end`, reports as its parameter `report` says."""

    end: Any

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.add_post_set_parameters_callback(self.configure)

    def configure(self, parameters: list[Parameter]) -> None:
        for parameter in parameters:
            if parameter.name == "report":
                self.end.configure_introspection(self.get_clock(), QoSProfile(depth=10), STATES[parameter.value])


class Adder(Reporting):
    def __init__(self) -> None:
        super().__init__("adder")
        self.end = self.create_service(AddTwoInts, "add", self.add)
        self.declare_parameter("report", "disabled")
        self.create_service(Trigger, "quiet", lambda _, response: response)
        hidden = self.create_service(Trigger, "_hidden", lambda _, response: response)
        best_effort = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
        hidden.configure_introspection(self.get_clock(), best_effort, ServiceIntrospectionState.CONTENTS)

    def add(self, request: Any, response: Any) -> Any:
        response.sum = request.a + request.b
        return response


class Asker(Reporting):
    """Asks for 2 + 3 again and again, once the answer before has come."""

    def __init__(self) -> None:
        super().__init__("asker")
        self.end = self.create_client(AddTwoInts, "add")
        self.declare_parameter("report", "disabled")
        self.future: Any = None
        self.create_timer(0.05, self.ask)

    def ask(self) -> None:
        if self.end.service_is_ready() and (self.future is None or self.future.done()):
            self.future = self.end.call_async(AddTwoInts.Request(a=2, b=3))


@pytest.fixture(scope="module", autouse=True)
def world(fresh_domain: None) -> Iterator[None]:
    with running(Adder, Asker):
        yield


def report(**states: str) -> None:
    """Have the nodes report their calls so, by `ros2 param set`."""
    for node, state in states.items():
        assert ros2("param", "set", f"/{node}", "report", state).out == "Set parameter successful\n"


def echoed(*options: str, separator: str = "---\n", calls: int = 2) -> list[str]:
    """What is echoed of each moment of a whole call, the first of which nothing was missed."""
    with Running("service", "echo", "/add", *options) as echo:
        echo.until(separator, count=4 * (calls + 1))
        echo.interrupt()
        outcome = echo.end(timeout=10)
    assert (outcome.err, outcome.status) == ("", signal.SIGINT)
    events = outcome.out.split(separator)
    begin = next(n for n, event in enumerate(events) if "REQUEST_SENT" in event)
    return events[begin : begin + 4]


def test_each_moment_is_printed_with_what_was_asked_and_answered() -> None:
    report(adder="contents", asker="contents")
    events = [yaml.safe_load(event) for event in echoed()]
    assert [event["info"]["event_type"] for event in events] == MOMENTS
    assert [event["request"] for event in events] == [[{"a": 2, "b": 3}], [{"a": 2, "b": 3}], [], []]
    assert [event["response"] for event in events] == [[], [], [{"sum": 5}], [{"sum": 5}]]
    assert len({event["info"]["sequence_number"] for event in events}) == 1
    assert {len(event["info"]["client_gid"]) for event in events} == {16}
    stamps = [(event["info"]["stamp"]["sec"], event["info"]["stamp"]["nanosec"]) for event in events]
    assert stamps == sorted(stamps)


def test_in_flow_style_a_moment_reads_as_in_the_tutorial() -> None:
    report(adder="contents", asker="metadata")
    sent, received, answered, _ = (A_NUMBER.sub("N", event) for event in echoed("--flow-style"))
    info = "info:\n  event_type: {}\n  stamp:\n    sec: N\n    nanosec: N\n  client_gid: GID\n  sequence_number: N\n"

    def without_gid(event: str) -> str:
        return re.sub(r"\[\d+(, \d+){15}\]", "GID", event)

    assert without_gid(sent) == f"{info.format('REQUEST_SENT')}request: []\nresponse: []\n"
    assert without_gid(received) == f"{info.format('REQUEST_RECEIVED')}request: [{{a: 2, b: 3}}]\nresponse: []\n"
    assert without_gid(answered) == f"{info.format('RESPONSE_SENT')}request: []\nresponse: [{{sum: 5}}]\n"


def test_without_arrays_their_types_and_lengths_are_shown() -> None:
    report(adder="contents", asker="contents")
    sent, *_ = echoed("--no-arr")
    kind = "<sequence type: example_interfaces/srv/AddTwoInts_{}[1], length: {}>"
    assert "  client_gid: '<array type: uint8[16]>'\n" in sent
    assert f"request: '{kind.format('Request', 1)}'\nresponse: '{kind.format('Response', 0)}'\n" in sent


def test_arrays_are_cut_after_as_many_elements_as_are_wanted() -> None:
    report(adder="contents", asker="contents")
    sent = yaml.safe_load(echoed("example_interfaces/srv/AddTwoInts", "-l", "2")[0])
    assert (sent["info"]["event_type"], sent["request"]) == ("REQUEST_SENT", [{"a": 2, "b": 3}])
    assert sent["info"]["client_gid"][2:] == ["..."]


def test_as_a_table_a_moment_has_its_number() -> None:
    report(adder="contents", asker="contents")
    with Running("service", "echo", "/add", "--csv") as echo:
        wait_until(lambda: len(echo.lines) >= 8)
        echo.interrupt()
        lines = list(csv.reader(echo.end(timeout=10).out.splitlines()))
    rows = lines[next(n for n, row in enumerate(lines) if row[0] == str(ServiceEventInfo.REQUEST_SENT)) :][:4]
    assert [row[0] for row in rows] == ["0", "1", "2", "3"]
    assert [row[20:] for row in rows] == [["2", "3", ""]] * 2 + [["", "5"]] * 2  # after the gid and the number


def test_only_the_end_that_reports_is_seen() -> None:
    report(adder="metadata", asker="disabled")
    with Running("service", "echo", "/add") as echo:
        echo.until("---\n", count=4)
        echo.interrupt()
        events = list(yaml.safe_load_all(echo.end(timeout=10).out))[:4]
    assert {event["info"]["event_type"] for event in events} == {"REQUEST_RECEIVED", "RESPONSE_SENT"}
    assert [(event["request"], event["response"]) for event in events] == [([], [])] * 4


def test_a_service_that_nobody_reports_is_said_and_waited_for() -> None:
    report(adder="disabled", asker="disabled")
    said = "No publishers on topic '/add/_service_event'; is service introspection on the client or server enabled?\n"
    with Running("service", "echo", "/add") as echo:
        echo.until(said)
        report(adder="contents")
        echo.until("RESPONSE_SENT")
        echo.interrupt()
        outcome = echo.end(timeout=10)
    assert (outcome.out.count(said), outcome.err, outcome.status) == (1, "", signal.SIGINT)


def test_reports_that_do_not_fit_are_said() -> None:
    with Running("service", "echo", "/_hidden") as echo:
        echo.until("incompatible QoS. No messages will be received from it. Last incompatible policy: RELIABILITY")
        echo.interrupt()
        assert echo.end(timeout=10).status == signal.SIGINT


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (("/nobody",), "Cannot find type for '/nobody'"),
        (("add",), "Cannot find type for 'add'\nDid you mean /add?"),
        (
            ("/add", "example_interfaces/srv/AddTwoInt"),
            "The service type 'example_interfaces/srv/AddTwoInt' is invalid",
        ),
        (("/add", "std_msgs/msg/String"), "The service type 'std_msgs/msg/String' is invalid"),
    ],
)
def test_what_cannot_be_echoed_is_said_in_a_line(words: tuple[str, ...], error: str) -> None:
    outcome = ros2("service", "echo", *words)
    assert (outcome.out, outcome.status) == ("", 1)
    assert outcome.err.startswith(f"{error}\n")


def test_in_a_notebook_it_ends_after_its_duration(capfd: pytest.CaptureFixture[str]) -> None:
    from course_kit.cli.ros2.command import run

    report(adder="contents", asker="contents")
    assert run(["service", "echo", "/add", "--duration", "2"]) == 0
    out = capfd.readouterr().out
    assert all(moment in out for moment in MOMENTS)
