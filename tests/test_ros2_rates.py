"""`ros2 topic hz`, `bw`, `delay` and `pub` measure true: on simulated time, on latched topics, of several topics."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np
import pytest

from course_kit.cli.ros2.topic.hz_bw_delay_text import hz_table
from course_kit.lab.recordings.rate_statistics import measure
from tests.domains import own_domain
from tests.ros2_command import program, ros2
from tests.ros2_running import Running
from tests.waiting import wait_until

pytestmark = pytest.mark.by_turns("many nodes and programs")

RATE = re.compile(r"average rate: (\S+)\n\tmin: (\S+)s max: (\S+)s std dev: \S+s window: (\d+)\n")
DELAY = re.compile(r"average delay: (\S+)\n\tmin: (\S+)s max: (\S+)s std dev: \S+s window: (\d+)\n")
BANDWIDTH = re.compile(r"(\d+) B/s from (\d+) messages\n\tMessage size mean: 8 B min: 8 B max: 8 B\n")
ROW = re.compile(r"(/\w+) +(\d+\.\d{3}) +\d+\.\d{3} +\d+\.\d{3} +\d+\.\d{5} +\d+ *\n")
SIMULATED = pytest.approx(25.0, rel=0.1)  # Hz of /ticks; on a busy machine the clock is heard a little late
ON_THE_WALL = 21.0  # Hz of it at most
KEPT = 50  # messages at least that /kept has kept


@pytest.fixture(scope="module", autouse=True)
def simulation() -> Iterator[None]:
    with own_domain(), program("tests.ros2_simulation"):
        yield


def readings(pattern: re.Pattern[str], *words: str, count: int = 3) -> list[tuple[float, ...]]:
    """The numbers of so many readings of a verb of `ros2 topic`, which is interrupted then."""
    with Running("topic", *words) as running:
        wait_until(lambda: len(pattern.findall(running.out)) >= count, f"{words}", timeout=60)
        running.interrupt()
        outcome = running.end()
    assert outcome.err == ""
    return [tuple(map(float, numbers)) for numbers in pattern.findall(outcome.out)]


def test_hz_goes_by_simulated_time_unless_it_is_told_not_to():
    assert readings(RATE, "hz", "-s", "/ticks")[-1][0] == SIMULATED
    assert readings(RATE, "hz", "-s", "--wall-time", "/ticks")[-1][0] < ON_THE_WALL
    assert readings(RATE, "hz", "/ticks")[-1][0] < ON_THE_WALL


def test_bw_goes_by_simulated_time():
    assert readings(BANDWIDTH, "bw", "-s", "/ticks")[-1][0] == pytest.approx(8 * 25, rel=0.1)
    assert readings(BANDWIDTH, "bw", "/ticks")[-1][0] < 8 * ON_THE_WALL


def test_delay_goes_by_simulated_time():
    assert readings(DELAY, "delay", "-s", "/stamped")[-1][0] == pytest.approx(0.25, abs=0.15)
    assert readings(DELAY, "delay", "/stamped", count=1)[-1][0] > 1e6


def test_readings_begin_anew_when_simulated_time_does():
    with Running("topic", "hz", "-s", "/ticks") as hz:
        hz.until("average rate", count=2)
        assert ros2("topic", "pub", "--once", "/reset", "std_msgs/msg/Empty").status == 0
        hz.until("time has reset, resetting counters\n")
        before = len(hz.out)
        wait_until(lambda: len(RATE.findall(hz.out[before:])) >= 2, timeout=60)
        hz.interrupt()
        hz.end()
    rate, shortest, longest, window = map(float, RATE.findall(hz.out[before:])[-1])
    assert rate == SIMULATED
    assert 0 <= shortest <= longest < 1.0  # the reset is no period
    assert window < 250  # what came before it is forgotten


def test_pub_keeps_its_rate_in_simulated_time():
    words = ("/from_here", "geometry_msgs/msg/PointStamped", "{header: auto}")
    out = ros2("topic", "pub", "-s", "-r", "5", "-t", "8", "-w", "0", *words).out
    times = [int(s) + int(n) * 1e-9 for s, n in re.findall(r"Time\(sec=(\d+), nanosec=(\d+)\)", out)]
    assert len(times) == 8
    assert 1.1 < times[-1] - times[1] < 3.0  # six periods; the first message may come before the clock is heard


def test_what_a_publisher_has_kept_is_not_measured():
    _, shortest, _, window = readings(RATE, "hz", "/kept", count=1)[0]
    assert (shortest > 0.05, window < KEPT) == (True, True)  # kept messages come at once
    assert readings(DELAY, "delay", "/kept", count=1)[0][2] < 50
    with Running("topic", "bw", "/kept") as bw:
        bw.until("Message size")
        bw.interrupt()
        bw.end()
    size = re.search(r"from (\d+) messages", bw.out)
    assert size is not None
    assert int(size[1]) < KEPT


def test_echo_prints_what_a_publisher_has_kept():
    out = ros2("topic", "echo", "/kept", "--timeout", "3", "--field", "header.frame_id").out
    assert out.count("---\n") >= KEPT


def test_hz_counts_messages_that_match():
    assert readings(RATE, "hz", "-s", "--filter", "m.data % 2 == 0", "/ticks")[-1][0] == pytest.approx(12.5, rel=0.1)


def test_hz_of_several_topics_is_a_table():
    with Running("topic", "hz", "-s", "/ticks", "/stamped", "/ticks") as hz:
        wait_until(lambda: len(ROW.findall(hz.out)) >= 6, timeout=60)
        hz.interrupt()
        out = hz.end().out
    lines = out.splitlines()
    assert lines[:2] == ["Subscribed to [/ticks]", "Subscribed to [/stamped]"]
    assert re.fullmatch(r" +topic +rate +min_delta +max_delta +std_dev +window", lines[2])
    assert lines[3] == "=" * len(lines[2])
    assert lines[6] == ""
    assert {topic: float(rate) for topic, rate in ROW.findall(out)} == {"/ticks": SIMULATED, "/stamped": SIMULATED}


def test_after_a_pause_hz_goes_on_and_bw_has_faded():
    with Running("topic", "hz", "/work") as hz, Running("topic", "bw", "/work") as bw:
        hz.until("does not appear to be published yet")
        work = ("topic", "pub", "-r", "50", "-p", "0", "/work", "std_msgs/msg/Int32", "{data: 1}")
        with Running(*work) as pub:
            bw.until("B/s from", count=3)
            hz.until("average rate", count=2)
            pub.interrupt()
            pub.end()
        at_work = max(int(rate) for rate, _ in BANDWIDTH.findall(bw.out))
        wait_until(lambda: int(BANDWIDTH.findall(bw.out)[-1][0]) < at_work / 2, timeout=60)
        silent = len(RATE.findall(hz.out))
        with Running(*work) as pub:
            wait_until(lambda: len(RATE.findall(hz.out)) > silent + 1, timeout=60)
            pub.interrupt()
            pub.end()
        for one in (hz, bw):  # a killed one would leave something behind
            one.interrupt()
            one.end()
    assert float(RATE.findall(hz.out)[-1][2]) > 1.0  # the pause


def test_a_topic_on_which_time_stands_has_no_rate():
    stands = measure(np.array([5, 5, 5]), np.array([8, 8, 8]))
    assert ROW.findall(hz_table({"/still": stands})) == [("/still", "0.000")]
