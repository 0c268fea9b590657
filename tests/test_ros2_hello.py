"""`ros2 doctor hello`, and another machine that says hello: here a node and a socket that speak in its name."""

from __future__ import annotations

import re
import socket
import threading
from collections.abc import Iterator

import pytest
from rclpy.node import Node
from std_msgs.msg import String

from course_kit.cli.ros2.doctor.hello import GROUP, PORT
from course_kit.lab.background.running import running
from tests.ros2_command import ros2
from tests.ros2_running import Running
from tests.waiting import wait_until

pytestmark = pytest.mark.usefixtures("fresh_domain")
HELLO = "hello, it's me elsewhere"
TABLE = r"""MULTIMACHINE COMMUNICATION SUMMARY
Topic: {topic}, Published Msg Count: (\d+)
Subscribed from:
                Hostname             Msg Count /{period}s
((?:.*\n)*?)Multicast Group/Port: 225\.0\.0\.1/49150, Sent Msg Count: (\d+)
Received from:
                Hostname             Msg Count /{period}s
((?:.*\n)*?)------------------------------------------------------------
"""


class Elsewhere(Node):
    """Says hello on a topic, and hears who does."""

    def __init__(self) -> None:
        super().__init__("elsewhere")
        self.heard: list[str] = []
        self.said = self.create_publisher(String, "/canyouhearme", 10)
        self.create_subscription(String, "/canyouhearme", self.hear, 10)
        self.create_timer(0.05, lambda: self.said.publish(String(data=HELLO)))

    def hear(self, message: String) -> None:
        self.heard.append(message.data)


def can_multicast() -> bool:
    """Return True if this machine lets a datagram go to the group."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
        try:
            return bool(out.sendto(b"-", (GROUP, PORT)))
        except OSError:
            return False


@pytest.fixture
def datagrams() -> Iterator[None]:
    """Datagrams of that other machine, and some that are none of `hello`'s."""
    over = threading.Event()

    def send() -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
            while not over.wait(0.05):
                for data in (HELLO.encode(), b"", b"\xff\xfe"):
                    out.sendto(data, (GROUP, PORT))

    thread = threading.Thread(target=send)
    thread.start()
    yield
    over.set()
    thread.join()


def test_it_is_said_once():
    once = ros2("doctor", "hello", "--once", "-pp", "0.5", "-t", "hi", ROS_AUTOMATIC_DISCOVERY_RANGE="LOCALHOST")
    table = re.fullmatch(TABLE.format(topic="hi", period="0.5"), once.out)
    assert table, once.out
    assert (table[1], table[2], table[3], once.status) == ("1", "", str(int(can_multicast())), 0)
    alone, *refused = once.err.splitlines()
    assert alone.startswith("ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST keeps nodes of other machines away")
    assert bool(refused) != can_multicast(), refused


def test_another_machine_on_the_topic_is_counted_and_hears_it():
    with running(Elsewhere) as node, Running("wtf", "hello", "--print-period", "0.5") as hello:
        hello.until("elsewhere", count=2)
        wait_until(lambda: set(node.heard) == {HELLO, f"hello, it's me {socket.gethostname()}"})
        hello.interrupt()
        ended = hello.end()
    assert re.search(r"\n {16}elsewhere {12}\d+ +\n", ended.out), ended.out
    assert socket.gethostname() not in ended.out  # it does not count itself
    assert "Traceback" not in ended.err
    assert ended.status == 2


@pytest.mark.skipif(not can_multicast(), reason="this machine has no way for multicast")
def test_another_machine_that_sends_datagrams_is_counted(datagrams: None):
    with Running("doctor", "hello", "-pp", "0.5", "--ttl", "1") as hello:
        hello.until("elsewhere", count=2)
        hello.interrupt()
        ended = hello.end()
    tables = re.findall(TABLE.format(topic="/canyouhearme", period="0.5"), ended.out)
    assert all(int(published) and int(sent) for published, _, sent, _ in tables[1:])
    assert any(re.search(r"^ {16}elsewhere +\d", received, re.MULTILINE) for *_, received in tables)
    assert not any(subscribed for _, subscribed, _, _ in tables)


def test_it_ends_after_the_duration():
    ended = ros2("doctor", "hello", "--duration", "0.2")
    assert (ended.status, ended.seconds < 20.0) == (0, True)
