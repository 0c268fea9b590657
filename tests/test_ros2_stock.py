"""Beside programs with DDS as it comes, as apt's and a robot's are: what is late, and whom that is said of."""

from __future__ import annotations

import os
import signal
import socket
from collections.abc import Iterator

import pytest

from course_kit.ros.private_api.fastdds_parts import participants_listening
from course_kit.ros.private_api.rtps_parts import ask_to_announce
from tests.benchmark.child import Program
from tests.domains import own_domain
from tests.ros2_command import ros2
from tests.waiting import wait_until

TIMEOUT = 20.0  # seconds


@pytest.fixture(scope="module")
def domain() -> Iterator[int]:
    with own_domain() as domain:
        yield domain


@pytest.fixture(scope="module")
def stock(domain: int) -> Iterator[Program]:
    with Program("idle_node", domain=domain, profile="stock") as program:
        program.report()
        yield program


def test_a_participant_tells_of_itself_who_asks(domain, stock):
    (port,) = participants_listening(domain) or ()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as hearing:
        hearing.bind(("127.0.0.1", 0))
        hearing.settimeout(TIMEOUT)
        ask_to_announce([port], hears=hearing.getsockname()[1])
        told = hearing.recv(65536)
    assert told[:4] == b"RTPS"
    assert b"enclave=" in told  # what ROS has a participant say


def test_who_asks_is_no_node(domain, stock):
    listening = participants_listening(domain) or {}
    ask_to_announce(listening, hears=min(listening) + 2)
    names = [name for name in ros2("node", "list", "-a").out.splitlines() if not name.startswith("/_ros2cli")]
    assert names == ["/idle"]


def test_a_list_that_waits_says_for_whom(domain, stock):
    with Program("warm_nodes", 0, 1, 1, domain=domain, profile="stock") as hung:
        hung.report()
        os.kill(hung.pid, signal.SIGSTOP)
        try:
            listed = ros2("node", "list")
        finally:
            os.kill(hung.pid, signal.SIGCONT)
        assert listed.status == 0
        (line,) = listed.late.splitlines()
        assert line.startswith("Waiting for process ")
        assert f"process {hung.pid} (" in line
        assert "warm_nodes" in line
        wait_until(lambda: "/warm_0_0" in (told := ros2("node", "list")).out and not told.late)
