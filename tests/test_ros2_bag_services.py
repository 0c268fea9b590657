"""Calls of services in bags: recorded with `ros2 bag record --services`, played as events or as calls."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from example_interfaces.srv import AddTwoInts
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import deserialize_message
from rclpy.service_introspection import ServiceIntrospectionState
from service_msgs.msg import ServiceEventInfo

from course_kit.lab import bags
from course_kit.lab.background.running import run, stop
from course_kit.ros.subscriptions import clients, observer_node
from tests.ros2_command import ros2
from tests.ros2_running import Running
from tests.waiting import wait_until

pytestmark = pytest.mark.usefixtures("fresh_domain")
EVENTS = "/_service_event"


class Adder(Node):
    """Offers /add, whose events have what is asked and answered, and /dumb, whose events do not."""

    def __init__(self) -> None:
        super().__init__("adder")
        self.asked: list[tuple[str, int]] = []
        contents, metadata = ServiceIntrospectionState.CONTENTS, ServiceIntrospectionState.METADATA
        for name, told in (("add", contents), ("dumb", metadata), ("silent", ServiceIntrospectionState.OFF)):

            def answer(request: Any, response: Any, name: str = name) -> Any:
                self.asked.append((name, request.a))
                return AddTwoInts.Response(sum=request.a + request.b)

            service = self.create_service(AddTwoInts, name, answer)
            kept = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)  # for who connects late
            service.configure_introspection(self.get_clock(), kept, told)


@pytest.fixture
def adder(fresh_domain: Any) -> Iterator[Adder]:
    node = run(Adder)
    yield node
    stop(node)


def call(name: str, number: int) -> None:
    clients.call(AddTwoInts, name, AddTwoInts.Request(a=number, b=1), 10.0, 10.0)


def recorded(folder: Path, *options: str) -> Path:
    """A bag of three calls of /add and one each of /dumb and /silent, while two services tell of theirs."""
    with Running("bag", "record", "-o", folder, *options) as recording:
        for name in ("/add",) if "--services" in options else ("/add", "/dumb"):
            recording.until(f"Subscribed to topic '{name}{EVENTS}'")
        for number in range(3):
            call("/add", number)
        call("/dumb", 7)
        call("/silent", 8)
        recording.interrupt()
        assert recording.end().status in (0, signal.SIGINT)
    return folder


def topics(folder: Path) -> dict[str, int]:
    return {topic.name: topic.count for topic in bags.info(folder).topics if topic.count}


def test_calls_are_recorded_and_made_again(adder: Adder, tmp_path: Path) -> None:
    bag = recorded(tmp_path / "bag", "--services", "/add")
    assert topics(bag) == {f"/add{EVENTS}": 6}
    info = ros2("bag", "info", str(bag)).out
    assert "Service: /add | Type: example_interfaces/srv/AddTwoInts | Event Count: 6 |" in info
    adder.asked.clear()
    again = ros2("bag", "play", str(bag), "--publish-service-requests")
    assert again.status == 0
    assert adder.asked == [("add", number) for number in range(3)]
    adder.asked.clear()
    kinds: list[int] = []

    def receive(data: bytes, info: dict[str, Any]) -> None:
        kinds.append(deserialize_message(data, AddTwoInts.Event).info.event_type)

    with closing(observer_node.subscribe(f"/add{EVENTS}", receive, AddTwoInts.Event)):
        wait_until(lambda: len(kinds) == 12)  # the server's own, kept
        kinds.clear()
        assert ros2("bag", "play", str(bag)).status == 0
        wait_until(lambda: len(kinds) == 6)
    assert kinds == [ServiceEventInfo.REQUEST_RECEIVED, ServiceEventInfo.RESPONSE_SENT] * 3
    assert adder.asked == []


def test_all_services_are_recorded_and_some_played(adder: Adder, tmp_path: Path) -> None:
    bag = recorded(tmp_path / "bag", "--all-services")
    assert topics(bag) == {f"/add{EVENTS}": 6, f"/dumb{EVENTS}": 2}
    adder.asked.clear()
    played = ros2("bag", "play", str(bag), "--publish-service-requests", "--exclude-services", "/add")
    assert "The events of /dumb have no requests in them" in played.err
    assert (adder.asked, played.status) == ([], 0)
    assert ros2("bag", "play", str(bag), "--publish-service-requests", "--services", "/add").status == 0
    assert adder.asked == [("add", number) for number in range(3)]
    stop(adder)
    alone = ros2("bag", "play", str(bag), "--publish-service-requests", "--regex", "^/add$")
    assert alone.err.count("Nobody offers /add: its requests are not sent.") == 1
    assert alone.status == 0


def test_topics_alone_or_all_but_some_services(adder: Adder, tmp_path: Path) -> None:
    bag = recorded(tmp_path / "bag", "--all", "--exclude-services", "/silent")
    assert {f"/add{EVENTS}": 6, f"/dumb{EVENTS}": 2}.items() <= topics(bag).items()
    with Running("bag", "record", "-o", tmp_path / "topics", "--all-topics") as recording:
        recording.until("Hidden topics are not recorded")
        call("/add", 1)
        recording.interrupt()
        recording.end()
    assert not [name for name in topics(tmp_path / "topics") if name.endswith(EVENTS)]
