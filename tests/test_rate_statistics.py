"""Rates, periods and bandwidth: the numbers against their definition, and against what a sender really sent."""

from __future__ import annotations

import gc
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from rclpy.node import Node
from std_msgs.msg import String

from course_kit.lab.recordings.rate_statistics import ArrivalWindow, measure, rate_over_time, spread
from course_kit.lab.recordings.rates import Rates, measure_rates, rates
from course_kit.ros.spinning import context
from tests.senders import Sender
from tests.waiting import wait_until

# A busy machine is no reason to fail.
patient = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
EPOCH = 1_800_000_000_000_000_000  # nanoseconds: as big as real ones, where float64 is too coarse
arrivals = st.lists(st.tuples(st.integers(1, 10**10), st.integers(0, 10**6)), min_size=2, max_size=60)


def at(*milliseconds: float) -> Any:
    return EPOCH + np.array([round(t * 1e6) for t in milliseconds], np.int64)


def test_the_rate_is_that_of_ros2_topic_hz() -> None:
    reading = measure(at(0, 10, 30, 40), np.array([100, 100, 200, 200]))
    assert reading.rate == pytest.approx(75.0)
    assert reading.period.min == pytest.approx(0.010) and reading.period.max == pytest.approx(0.020)
    assert reading.period.std == pytest.approx(np.std([0.01, 0.02, 0.01]))  # of the population
    assert (reading.size.mean, reading.size.min, reading.size.max) == (150, 100, 200)
    assert reading.bandwidth == pytest.approx(150 * 75.0)
    assert (reading.messages, reading.window) == (4, 4)


@patient
@given(arrivals)
def test_rate_and_mean_period_belong_together(steps: list[tuple[int, int]]) -> None:
    receive_ns = EPOCH + np.cumsum([step for step, _ in steps])
    reading = measure(receive_ns, np.array([size for _, size in steps]))
    assert reading.rate * reading.period.mean == pytest.approx(1.0)
    assert reading.period.min <= reading.period.mean * (1 + 1e-12) and reading.period.std >= 0
    assert reading.bandwidth == pytest.approx(reading.rate * np.mean([size for _, size in steps]))


@pytest.mark.parametrize("count", [0, 1])
def test_without_two_messages_there_is_no_rate(count: int) -> None:
    reading = measure(at(*range(count)), np.ones(count, np.int64), now_ns=EPOCH + 10**9)
    assert math.isnan(reading.rate) and math.isnan(reading.period.mean) and reading.messages == count
    assert math.isnan(reading.age) if count == 0 else reading.age == pytest.approx(1.0)
    assert math.isnan(spread([]).mean)


def test_times_and_sizes_must_belong_together() -> None:
    with pytest.raises(ValueError, match="3 receive times for 1 sizes"):
        measure(at(1, 2, 3), np.ones(1, np.int64))


@patient
@given(st.lists(st.integers(0, 10**6), max_size=80), st.integers(2, 20))
def test_a_window_has_the_last_messages_in_order(values: list[int], size: int) -> None:
    window = ArrivalWindow(size)
    append = window.appender()
    for value in values:
        append(value, value + 1)
    receive_ns, sizes, total = window.arrivals()
    assert receive_ns.tolist() == values[-size:] and sizes.tolist() == [v + 1 for v in values[-size:]]
    assert total == window.count == len(values)


def test_a_window_of_one_message_is_refused() -> None:
    with pytest.raises(ValueError, match="a rate needs two messages"):
        ArrivalWindow(1)


def test_the_rate_over_time_of_a_steady_topic_is_level_and_of_a_pause_is_not() -> None:
    edges, hertz = rate_over_time(at(*np.arange(0, 1000, 16)))
    assert hertz == pytest.approx(62.5) and edges[0] == 0 and edges[-1] == pytest.approx(0.992)
    paused = np.concatenate([np.arange(0, 1000, 10), np.arange(3000, 4000, 10)])
    edges, hertz = rate_over_time(at(*paused))
    middle = (edges[1:] + edges[:-1]) / 2
    assert hertz[(middle > 1.3) & (middle < 2.7)].max() < 1.0
    assert hertz[middle < 0.8] == pytest.approx(100)


@patient
@given(arrivals)
def test_the_rate_over_time_loses_no_message(steps: list[tuple[int, int]]) -> None:
    receive_ns = EPOCH + np.cumsum([step for step, _ in steps])
    edges, hertz = rate_over_time(receive_ns)
    assert float((hertz * np.diff(edges)).sum()) == pytest.approx(len(steps) - 1)


# With real traffic.


@pytest.fixture
def talker() -> Iterator[Node]:
    context.start()
    node = Node("talker")
    yield node
    node.destroy_node()


@pytest.mark.parametrize(("kind", "size"), [("string", 24), ("scan", 1508)])
def test_a_fast_topic_is_measured_as_it_was_sent(kind: str, size: int) -> None:
    count = 10_000
    with Sender("/fast", kind, rate=5000, count=count) as sender:
        with measure_rates("/fast", window=count) as meter:
            sender.go()
            sent = sender.result()
            wait_until(lambda: meter.read()["/fast"].messages == count)
        reading = meter.read()["fast"]
    # On a busy machine the last message may arrive late, and that is then the truth.
    assert reading.rate == pytest.approx(sent["rate"], rel=0.2)
    assert reading.size.min == reading.size.max == size
    assert reading.bandwidth == pytest.approx(size * reading.rate)
    assert reading.lost == 0


def test_many_topics_are_measured_at_once_and_shown_as_a_table() -> None:
    with Sender("/fast", "scan", rate=200, count=100_000) as fast, Sender("/slow", rate=20, count=100_000) as slow:
        fast.go()
        slow.go()
        measured = rates("/fast", "slow", seconds=1.5)
    assert list(measured) == ["/fast", "/slow"] and len(measured) == 2
    assert measured["/fast"].rate == pytest.approx(200, rel=0.2)
    assert measured["/slow"].rate == pytest.approx(20, rel=0.2)
    heading, first, second = repr(measured).splitlines()
    assert heading.split()[:4] == ["topic", "rate", "period", "min"]
    assert first.startswith("/fast  ") and " Hz " in first and "kB/s" in first and second.startswith("/slow  ")
    with pytest.raises(KeyError, match="/other was not measured; there are /fast, /slow"):
        measured["/other"]


def test_without_topics_all_that_are_published_are_measured(talker: Node) -> None:
    publisher = talker.create_publisher(String, "/chatter", 10)
    with measure_rates() as meter:
        assert "/chatter" in meter.topics and "/rosout" not in meter.topics
        publisher.publish(String(data="x"))
        wait_until(lambda: meter.read()["/chatter"].messages == 1)
    assert "1     0  0.0 s ago" in next(line for line in repr(meter).splitlines() if "/chatter" in line)


def test_a_silent_topic_shows_that_nothing_came(talker: Node) -> None:
    talker.create_publisher(String, "/silent", 10)
    assert repr(rates("/silent", seconds=0.05)).endswith("0     0  none came")


def test_a_meter_runs_until_it_is_stopped_or_forgotten(talker: Node) -> None:
    publisher = talker.create_publisher(String, "/chatter", 100)
    meter = measure_rates("/chatter")
    for _ in range(20):
        publisher.publish(String(data="x"))
    wait_until(lambda: meter.read()["/chatter"].messages == 20)
    assert meter.is_running and isinstance(meter.stop(), Rates) and not meter.is_running
    publisher.publish(String(data="x"))
    assert meter.read()["/chatter"].messages == 20
    measure_rates("/chatter")
    gc.collect()
    wait_until(lambda: publisher.get_subscription_count() == 0)


def test_a_topic_that_nobody_publishes_is_refused_unless_its_type_is_given() -> None:
    with pytest.raises(TimeoutError, match="no node publishes /nobody"):
        rates("/nobody", timeout=0.1)
    assert rates("/nobody", String, seconds=0.01)["/nobody"].messages == 0
