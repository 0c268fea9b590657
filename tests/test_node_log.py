"""The checker's reading of /rosout: which node said it, told by the publisher and not by the name."""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Iterator

import pytest
from rclpy.node import Node

from course_kit.ros.observing import node_log
from course_kit.ros.observing.domain_observer import DomainObserver
from course_kit.ros.observing.node_log import NodeLog
from course_kit.ros.spinning import context
from tests.waiting import wait_until

pytestmark = pytest.mark.usefixtures("fresh_domain")


@pytest.fixture
def observer() -> Iterator[DomainObserver]:
    context.start()
    observer = DomainObserver(None, only_here=False)
    yield observer
    observer.close()


def talker_publishers(observer: DomainObserver) -> list[bytes]:
    return [bytes(end.endpoint_gid) for end in observer.publishers("/rosout") if end.node_name == "talker"]


def texts(log: NodeLog, publishers: Collection[bytes]) -> list[str]:
    return [message.msg for message in log.said_by(publishers, "talker")]


def test_a_node_is_not_given_the_lines_of_the_one_of_its_name_before(observer):
    log = observer.node_log()
    first = Node("talker")
    first.get_logger().info("the first")
    wait_until(lambda: log.lines("talker"))
    (before,) = wait_until(lambda: talker_publishers(observer))
    first.destroy_node()
    second = Node("talker")
    later = wait_until(lambda: set(talker_publishers(observer)) - {before})
    assert texts(log, later) == []  # it has said nothing, however late the graph is looked at
    second.get_logger().info("the second")
    wait_until(lambda: len(log.lines("talker")) == 2)
    assert (texts(log, [before]), texts(log, later)) == (["the first"], ["the second"])
    second.destroy_node()


def test_lines_said_before_the_log_was_opened_are_in_it(observer):
    early = Node("talker")
    early.get_logger().info("early")
    log = observer.node_log()
    wait_until(lambda: log.lines("talker") and talker_publishers(observer))
    assert texts(log, talker_publishers(observer)) == ["early"]
    assert log.lines("nobody") == []
    early.destroy_node()


def test_lines_of_a_child_logger_are_the_nodes_and_those_of_a_longer_name_are_not(observer):
    log = observer.node_log()
    talker, other = Node("talker"), Node("talkers")
    talker.get_logger().get_child("details").info("of a child")
    other.get_logger().info("of another")
    wait_until(lambda: log.lines("talker") and log.lines("talkers") and talker_publishers(observer))
    assert texts(log, talker_publishers(observer)) == ["of a child"]
    talker.destroy_node()
    other.destroy_node()


def test_what_a_node_said_first_is_kept_however_much_is_said_after_it(observer, monkeypatch):
    monkeypatch.setattr(node_log, "FIRST", 3)
    log = observer.node_log()
    log._lines = deque(maxlen=5)
    talker = Node("talker")
    wait_until(lambda: talker_publishers(observer))
    for number in range(20):
        talker.get_logger().info(str(number))
    wait_until(lambda: texts(log, talker_publishers(observer))[-1:] == ["19"])
    assert texts(log, talker_publishers(observer)) == [str(number) for number in (0, 1, 2, 15, 16, 17, 18, 19)]
    talker.destroy_node()


def test_every_line_comes_and_in_its_order(observer):
    log = observer.node_log()
    assert observer.node_log() is log
    busy = Node("talker")
    wait_until(lambda: talker_publishers(observer))
    for number in range(2000):
        busy.get_logger().info(str(number))
    wait_until(lambda: len(log.lines("talker")) == 2000)
    assert texts(log, talker_publishers(observer)) == [str(number) for number in range(2000)]
    busy.destroy_node()
