"""Service calls: put together from what clients and servers report, and drawn."""

from __future__ import annotations

import math
import re
import time

import pytest
from example_interfaces.srv import AddTwoInts
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.service_introspection import ServiceIntrospectionState

from course_kit import record, run, stop, wait_for
from course_kit.lab.calls.sequences import Arrow, Bar, plot_calls, plot_sequence
from course_kit.lab.calls.service_calls import NAMES, calls_of

SERVICE = "/sequences/add"
EVENTS = f"{SERVICE}/_service_event"


def event(kind: str, number: int, seconds: float, client: int = 1) -> AddTwoInts.Event:
    """What a client or server reports about a call."""
    message = AddTwoInts.Event()
    message.info.event_type = NAMES.index(kind)
    message.info.sequence_number = number
    message.info.stamp.sec, message.info.stamp.nanosec = 7, round(seconds * 1e9)
    message.info.client_gid = [client] * 16
    return message


def whole_call(number: int, at: float, client: int = 1) -> list[AddTwoInts.Event]:
    return [event(kind, number, at + 0.1 * step, client) for step, kind in enumerate(NAMES)]


def test_a_call_is_put_together_from_its_four_events():
    (call,) = calls_of(reversed(whole_call(3, 0.2)))
    assert call.number == 3
    assert call.waiting == pytest.approx(0.1)
    assert call.working == pytest.approx(0.1)
    assert call.duration == pytest.approx(0.3)


def test_calls_come_in_the_order_of_their_requests():
    events = whole_call(2, 0.5) + whole_call(1, 0.1) + whole_call(1, 0.3, client=2)
    assert [call.number for call in calls_of(events)] == [1, 1, 2]


def test_a_call_without_a_response_has_no_duration():
    (call,) = calls_of(whole_call(1, 0.1)[:2])
    assert call.waiting == pytest.approx(0.1)
    assert math.isnan(call.working) and math.isnan(call.duration)


def test_a_request_that_found_the_server_busy_lay_in_its_queue():
    times = {1: (0.0, 0.001, 0.3, 0.301), 2: (0.002, 0.3, 0.6, 0.601)}
    two = [event(kind, number, at) for number in times for kind, at in zip(NAMES, times[number], strict=True)]
    calls = calls_of(two + whole_call(3, 0.7))
    assert [call.queued_among(calls) for call in calls] == [False, True, False]


def test_two_clients_of_one_process_are_refused():
    with pytest.raises(ValueError, match="two clients of one process"):
        calls_of(whole_call(1, 0.1) + whole_call(1, 0.2))


def test_a_figure_of_nothing_is_refused():
    with pytest.raises(ValueError, match="no message to draw"):
        plot_sequence(("client", "server"), [])


def test_a_lost_message_ends_in_a_cross_and_an_open_bar():
    arrows = [Arrow("a", "b", 1.0, math.nan), Arrow("a", "b", 1.0, 1.5)]
    axes = plot_sequence(("a", "b"), arrows, [Bar("a", 1.0, math.nan, is_hollow=True)]).axes[0]
    assert [line.get_marker() for line in axes.lines].count("x") == 1
    bar = axes.patches[0]
    assert bar.get_y() + bar.get_height() > 500.0  # beyond the last event, in ms


class Server(Node):
    def __init__(self):
        super().__init__("sequences_server")
        service = self.create_service(AddTwoInts, SERVICE, self.add)
        service.configure_introspection(self.get_clock(), QoSProfile(depth=100), ServiceIntrospectionState.METADATA)

    def add(self, request, response):
        time.sleep(0.05)
        if request.a < 0:
            raise ValueError("negative")
        response.sum = request.a + request.b
        return response


class Client(Node):
    def __init__(self):
        super().__init__("sequences_client")
        self.client = self.create_client(AddTwoInts, SERVICE)
        self.client.configure_introspection(self.get_clock(), QoSProfile(depth=100), ServiceIntrospectionState.METADATA)


@pytest.fixture
def client():
    run(Server)
    node = run(Client)
    assert node.client.wait_for_service(timeout_sec=10.0)
    yield node.client
    stop()


def test_real_calls_are_drawn_as_they_happened(client):
    with record(EVENTS) as events:
        futures = [client.call_async(AddTwoInts.Request(a=number, b=1)) for number in range(3)]
        assert [wait_for(future, timeout=10).sum for future in futures] == [1, 2, 3]
        wait_for(lambda: len(events) == 12)
    first, second, third = calls_of(events.messages)
    assert first.working >= 0.05
    assert second.request_received >= first.response_sent
    assert third.request_received >= second.response_sent
    plot = plot_calls(events)
    labels = [text.get_text().splitlines()[0] for text in plot.axes[0].get_legend().get_texts()]
    assert [label.split(":")[0] for label in labels] == ["call 1", "call 2", "call 3"]
    assert re.search(
        r"After .* ms, call 2: .* ms, .* ms in the queue, .* ms served\. After .* ms, call 3: ", repr(plot)
    )
    hatched = [bar for bar in plot.axes[0].patches if bar.get_hatch()]
    assert [bar.get_height() >= 40.0 * number for number, bar in enumerate(hatched, 1)] == [True, True]
    assert plot._repr_png_()[0].startswith(b"\x89PNG")


def test_a_call_that_raised_is_drawn_without_its_response(client):
    with record(EVENTS) as events:
        client.call_async(AddTwoInts.Request(a=-1))
        wait_for(lambda: len(events) == 2)
    assert plot_calls(events).axes[0].get_legend().get_texts()[0].get_text() == "call 1: no response"


def test_an_empty_recording_says_what_to_look_at(client):
    with record(EVENTS) as events:
        pass
    with pytest.raises(ValueError, match="configure_introspection"):
        plot_calls(events)


def test_another_topic_is_refused(client):
    with record("/rosout") as events, pytest.raises(ValueError, match="_service_event"):
        plot_calls(events)
