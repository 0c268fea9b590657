"""What the checker hears for hours in the student's domain, and that nothing of it is seen there."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import pytest
from geometry_msgs.msg import Twist
from rclpy.node import Node

from course_kit.examining.lookout import Lookout, Watched
from course_kit.examining.station import Station
from course_kit.examining.vocabulary_student import was_in_a_list_after
from course_kit.spinning import context
from tests.waiting import wait_until

pytestmark = pytest.mark.usefixtures("fresh_domain")
TOPIC = "/robot2/turtle1/cmd_vel"


@pytest.fixture
def station() -> Iterator[Station]:
    context.start()
    station = Station(None, only_here=False)
    yield station
    station.close()


@pytest.fixture
def lookout(station: Station) -> Iterator[Lookout]:
    lookout = Lookout(station)
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
    heard = Watched(Twist, TOPIC)
    said = [b"a", b"b", b"b", b"b", b"b", b"a", b"a", b"c"]
    for when, message in enumerate(said):
        heard.receive(message, {"received_timestamp": when, "publisher": b"1"})
    kept = [(one.received, one.serialised) for one in heard._kept]
    assert kept == [(0, b"a"), (1, b"b"), (4, b"b"), (5, b"a"), (6, b"a"), (7, b"c")]
    assert heard.received == len(said)


@pytest.mark.parametrize("is_late", [False, True])
def test_a_topic_that_the_checker_leaves_late_may_have_been_in_a_list(lookout, node, examination, is_late):
    lookout.watch("/turtle1/cmd_vel", Twist)
    lookout.watch(TOPIC, Twist)
    watched = lookout.watched[TOPIC]
    earlier = node.create_publisher(Twist, TOPIC, 1)
    wait_until(lambda: watched.is_open)
    with lookout._lock if is_late else contextlib.nullcontext():  # as on a busy machine
        node.destroy_publisher(earlier)
        wait_until(lambda: is_late or not watched.is_open)
        node.create_publisher(Twist, "turtle1/cmd_vel", 1)
        wait_until(lambda: lookout._station.publishers("/turtle1/cmd_vel"))
    wait_until(lambda: lookout.watched["/turtle1/cmd_vel"].appeared and not watched.is_open)
    examination.student, examination.watched = lookout._station, lookout.watched
    assert was_in_a_list_after("/pilot", "/turtle1/cmd_vel", TOPIC) == is_late
