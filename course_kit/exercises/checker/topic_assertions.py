"""Assertions about topics: publishers, subscriptions, types, QoS, messages, rates."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from itertools import pairwise
from typing import Any

import numpy as np
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from turtlesim.msg import Pose

from course_kit.exercises.checker.assertions import arrival_timeout, expect, expect_type, nearest, pause, require, wait
from course_kit.exercises.checker.examination import current
from course_kit.exercises.checker.wait_for_discovery import meet
from course_kit.lab.recordings.rate_statistics import measure
from course_kit.robots.turtlesim.turtle import TICK
from course_kit.ros.observing.received_messages import ReceivedMessages
from course_kit.ros.subscriptions import topics

MATCH_TIMEOUT = 3.0
LATEST_TICK = 3 * TICK


def expect_topic(topic: str, message_type: Any) -> None:
    """The answer publishes a topic of this type."""
    _expect_end(
        topic, message_type, "publishes", "publisher", current().test_domain.publishers, lambda node: node.publishers
    )


def expect_subscription(topic: str, message_type: Any) -> None:
    """The answer subscribes to a topic with this type."""
    ends = current().test_domain.subscriptions
    _expect_end(topic, message_type, "subscribes to", "subscription", ends, lambda node: node.subscribers)


def _expect_end(
    topic: str,
    message_type: Any,
    does: str,
    end: str,
    ends: Callable[[str], Sequence[Any]],
    of_node: Callable[[Any], dict[str, list[str]]],
) -> None:
    wait(lambda: ends(topic), arrival_timeout())
    endpoints = ends(topic)
    nodes = current().test_domain.their_nodes()
    theirs = sorted(
        {name for node in current().test_domain.offered() for name in of_node(node)} - {"/parameter_events"}
    )
    hint = f"`{topic}` has no {end}. "
    if not nodes:
        hint += "Is your node running? `%ros2 node list` shows it."
    elif theirs:
        hint += f"{nearest(topic, theirs)}Your node {does} {', '.join(theirs)}: `%ros2 node info {nodes[0]}` shows it."
    else:
        hint += f"Your node {does} no topic: `%ros2 node info {nodes[0]}` shows what it has."
    require(f"it {does} `{topic}`", endpoints, hint)
    hint = f" Ends of different types never meet, and nobody gets an error: `%ros2 topic info {topic}` shows the type."
    expect_type(topic, sorted({endpoint.topic_type for endpoint in endpoints}), message_type, hint)


def expect_compatible_subscription(topic: str, publisher: Publisher, points: int = 0) -> bool:
    """The answer's subscription takes what this publisher offers: they match."""
    wait(lambda: current().test_domain.subscriptions(topic), arrival_timeout())  # a program's come after its node
    matched = wait(lambda: publisher.get_subscription_count() > 0, topics.MISMATCH_TIMEOUT)
    asked = [subscription.qos_profile for subscription in current().test_domain.subscriptions(topic)]
    policies = None
    if any(qos.reliability == ReliabilityPolicy.RELIABLE for qos in asked):
        policies = "RELIABLE", "BEST_EFFORT"
    elif any(qos.durability == DurabilityPolicy.TRANSIENT_LOCAL for qos in asked):
        policies = "TRANSIENT_LOCAL", "VOLATILE"
    hint = "`%ros2 topic info -v` shows both sides."
    if policies:
        hint = (
            f"It asks for {policies[0]}, and the publisher offers {policies[1]} only, so DDS does not connect them. "
            f"`%ros2 topic info -v {topic}` shows both sides."
        )
    return expect(f"its subscription to `{topic}` matches the publisher's QoS", matched, hint, points, needed=True)


def matches(publisher: Publisher) -> bool:
    """Wait until the answer's subscription has matched this publisher; at once no if it asks for more reliability."""
    topic = publisher.topic_name
    meet(current().test_domain, topic)

    def asks_for_more() -> bool:
        asked = [subscription.qos_profile.reliability for subscription in current().test_domain.subscriptions(topic)]
        is_best_effort = publisher.qos_profile.reliability == ReliabilityPolicy.BEST_EFFORT
        return is_best_effort and bool(asked) and all(one == ReliabilityPolicy.RELIABLE for one in asked)

    wait(lambda: publisher.get_subscription_count() or asks_for_more(), topics.MISMATCH_TIMEOUT)
    return bool(publisher.get_subscription_count())


def is_published(topic: str) -> bool:
    """Return True if the answer has a publisher of a topic, which may come a little later than its node."""
    return wait(lambda: current().test_domain.publishers(topic), arrival_timeout())


def publisher(topic: str, message_type: Any, qos: QoSProfile | int = 10) -> Publisher:
    """A publisher of the checker's in the test domain."""
    return current().test_domain.check_node.create_publisher(message_type, topics.absolute(topic), qos)


def publish_steadily(to: Publisher, messages: Sequence[Any], period: float) -> None:
    """Publish messages one by one, `period` seconds apart, by the clock.

    One that is late is made up for in steps of at least half a period: two at once would be one for a depth of 1.
    """
    due = time.monotonic()
    for message in messages:
        to.publish(message)
        due += period
        pause(max(period / 2, due - time.monotonic()))


def listen(topic: str, message_type: Any) -> ReceivedMessages:
    """Hear what the answer says on a topic of the test domain from now on, until the check ends."""
    heard = current().test_domain.listen(topic, message_type)
    meet(current().test_domain, topic)
    return heard


@contextmanager
def heard_once_more(topic: str, message_type: Any) -> Iterator[list[tuple[int, Any]]]:
    """Another subscription: what comes, each with the number that its publisher gave it, 1 to the first it ever sent.

    Empty where the middleware does not number.
    """
    numbered: list[tuple[int, Any]] = []

    def take(message: Any, info: Any) -> None:
        if info["publication_sequence_number"] is not None:
            numbered.append((info["publication_sequence_number"], message))

    def subscribe(node: Node) -> None:
        qos = topics.qos_for(topic, current().test_domain.publishers(topic))
        qos.durability = DurabilityPolicy.VOLATILE
        node.create_subscription(message_type, topic, take, qos)  # type: ignore[arg-type]

    # destroy_subscription() would be too early: a thread that waits for it keeps it, and a new publisher could meet it.
    with current().test_domain.with_own_node(subscribe):
        meet(current().test_domain, topic)
        yield numbered


def hear_no_longer(heard: ReceivedMessages) -> None:
    """End a subscription of listen(), and let the answer's nodes learn of it; what has come is kept."""
    heard.subscription.close()
    meet(current().test_domain, heard.topic)


def hear_the_turtle() -> ReceivedMessages:
    """Hear the pose of turtle1 of a_turtle(), and what nobody else says of it, until the check ends."""
    heard = current().test_domain.listen("/turtle1/pose", Pose, own=True)
    wait(lambda: len(heard), MATCH_TIMEOUT, "the turtle's pose")
    return heard


def ticked_late(driven: ReceivedMessages, since: int) -> bool:
    """Return True if ticks of the simulator were late or missing since a pose of that number, as on a busy machine."""
    return any(after - before > LATEST_TICK * 1e9 for before, after in pairwise(driven.times[since:]))


def wait_until_quiet(heard: ReceivedMessages, quiet: float, timeout: float, at_most: int = 1_000_000) -> None:
    """Wait until something has come and then nothing for `quiet` seconds, `at_most` messages, or the time is over."""

    def is_quiet() -> bool:
        times = heard.times
        return len(times) >= at_most or bool(times and time.time_ns() - times[-1] > quiet * 1e9)

    wait(is_quiet, timeout, f"the end of {heard.topic}")


def values(heard: ReceivedMessages, field: str) -> list[Any]:
    """One field of all messages."""
    return [getattr(message, field) for message in heard.messages]


def rate(heard: ReceivedMessages) -> float:
    """Messages a second, as `ros2 topic hz` has it; nan below two messages."""
    return rate_of(heard.times)


def rate_of(times: Sequence[int]) -> float:
    """The same of what came at these times, nanoseconds."""
    received = np.asarray(times, np.int64)
    return measure(received, np.ones_like(received)).rate


def is_steady(times: Sequence[int], wanted: float, within: float) -> bool:
    """Return True if messages came at a rate (Hz), but for a part of it (`within`), most of them a period apart."""
    even = [0.5 < (after - before) * 1e-9 * wanted < 1.5 for before, after in pairwise(times)]
    return abs(rate_of(times) - wanted) <= within * wanted and sum(even) >= 0.7 * len(even)


def expect_rate(heard: ReceivedMessages, wanted: float, within: float) -> bool:
    """The messages came at a rate (Hz), but for a part of it (`within`)."""
    measured = rate(heard)
    came = f"{len(heard)} message came, too few for a rate." if math.isnan(measured) else f"It was {measured:.1f} Hz."
    return expect(
        f"`{heard.topic}` has {wanted:g} messages a second",
        abs(measured - wanted) <= within * wanted,
        f"{came} The period is in seconds: 1 / {wanted:g} = {1 / wanted:g}. "
        f"`%ros2 topic hz {heard.topic}` measures it.",
    )
