"""What the checker hears for hours in the student's domain, and that nothing of it is seen there."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from geometry_msgs.msg import Twist
from rclpy.node import Node

from course_kit.exercises.checker.student_assertions import was_listed_before
from course_kit.exercises.checker.student_monitor import StudentDomainMonitor, WatchedTopic
from course_kit.ros.observing.domain_observer import DomainObserver
from course_kit.ros.spinning import context
from tests.waiting import wait_until

pytestmark = pytest.mark.usefixtures("fresh_domain")
TOPIC = "/robot2/turtle1/cmd_vel"


@pytest.fixture
def observer() -> Iterator[DomainObserver]:
    context.start()
    observer = DomainObserver(None, only_here=False)
    yield observer
    observer.close()


@pytest.fixture
def lookout(observer: DomainObserver) -> Iterator[StudentDomainMonitor]:
    lookout = StudentDomainMonitor(observer)
    yield lookout
    lookout.close()


@pytest.fixture
def node() -> Iterator[Node]:
    context.start()
    node = Node("pilot")
    yield node
    node.destroy_node()


def listed(node: Node) -> bool:
    return TOPIC in dict(node.get_topic_names_and_types())


def test_a_topic_is_listed_only_as_long_as_a_node_has_it(lookout, node):
    lookout.watch(TOPIC, Twist)
    hidden = Node("_instruments")
    publisher = hidden.create_publisher(Twist, TOPIC, 1)
    hidden.destroy_publisher(publisher)
    hidden.destroy_node()
    wait_until(lambda: not listed(node))
    for _ in range(3):
        subscription = node.create_subscription(Twist, TOPIC, lambda _: None, 1)
        wait_until(lambda: node.count_subscribers(TOPIC) == 2)
        node.destroy_subscription(subscription)
        wait_until(lambda: not listed(node))


def test_what_is_said_is_heard_after_it_was_away_too(lookout, node):
    lookout.watch(TOPIC, Twist)
    heard = lookout.watched[TOPIC]
    for count in (1, 2):
        publisher = node.create_publisher(Twist, TOPIC, 1)
        wait_until(publisher.get_subscription_count)
        twist = Twist()
        twist.linear.x = float(count)
        wait_until(
            lambda twist=twist, publisher=publisher, count=count: publisher.publish(twist) or len(heard) >= count
        )
        node.destroy_publisher(publisher)
        wait_until(lambda: not listed(node))
    assert {message.linear.x for message in heard.messages} == {1.0, 2.0}
    assert len(heard.appeared) == 2


def test_of_what_is_said_again_and_again_the_first_and_the_last_are_kept():
    heard = WatchedTopic(Twist, TOPIC)
    said = [b"a", b"b", b"b", b"b", b"b", b"a", b"a", b"c"]
    for when, message in enumerate(said):
        heard.receive(message, {"received_timestamp": when, "publisher": b"1"})
    kept = [(one.received, one.serialised) for one in heard._kept]
    assert kept == [(0, b"a"), (1, b"b"), (4, b"b"), (5, b"a"), (6, b"a"), (7, b"c")]
    assert heard.received == len(said)


@pytest.mark.parametrize("is_left", [False, True])
def test_a_topic_may_be_listed_before_it_is_published(lookout, node, examination, is_left):
    lookout.watch(TOPIC, Twist)
    watched = lookout.watched[TOPIC]
    examination.student, examination.watched = lookout._observer, lookout.watched
    earlier = node.create_publisher(Twist, TOPIC, 1)
    wait_until(lambda: watched.is_open)
    assert not was_listed_before("/pilot", TOPIC)
    panel = Node("_panel")
    if is_left:
        panel.create_subscription(Twist, TOPIC, lambda _: None, 1)
        wait_until(lambda: node.count_subscribers(TOPIC) == 2)
    node.destroy_publisher(earlier)
    wait_until(lambda: not watched.is_open and listed(node) == is_left)
    wait_until(lambda: watched.is_listed == is_left)
    node.create_publisher(Twist, TOPIC, 1)
    wait_until(lambda: len(watched.appeared) == 2)
    assert was_listed_before("/pilot", TOPIC) == is_left
    panel.destroy_node()


def test_publishers_that_all_change_between_two_looks_leave_the_topic_listed(lookout, node, examination):
    lookout.watch(TOPIC, Twist)
    watched, observer = lookout.watched[TOPIC], lookout._observer
    examination.student, examination.watched = observer, lookout.watched
    earlier = node.create_publisher(Twist, TOPIC, 1)
    wait_until(lambda: watched.is_open)
    (old,) = watched.present
    with lookout._lock:  # as on a busy machine
        node.destroy_publisher(earlier)
        node.create_publisher(Twist, TOPIC, 1)
        wait_until(lambda: [end for end in observer.publishers(TOPIC) if bytes(end.endpoint_gid) != old])
        wait_until(lambda: len(observer.publishers(TOPIC)) == 1)
    wait_until(lambda: len(watched.appeared) == 2)
    assert was_listed_before("/pilot", TOPIC)
