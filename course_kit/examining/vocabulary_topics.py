"""What checks say about topics: who publishes and subscribes, with which type and QoS, what comes, and how often."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from turtlesim.msg import Pose

from course_kit.examining.examination import current
from course_kit.examining.introduction import meet
from course_kit.examining.station import Heard
from course_kit.examining.vocabulary import arrival_timeout, expect, expect_type, nearest, pause, require, wait
from course_kit.recordings.measure import measure
from course_kit.watching import topics

MATCH_TIMEOUT = 3.0


def expect_topic(topic: str, message_type: Any) -> None:
    """The answer publishes a topic of this type."""
    _expect_end(topic, message_type, "publishes", "publisher", current().stage.publishers, lambda node: node.publishers)


def expect_subscription(topic: str, message_type: Any) -> None:
    """The answer subscribes to a topic with this type."""
    ends = current().stage.subscriptions
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
    nodes = current().stage.their_nodes()
    theirs = sorted({name for node in current().stage.offered() for name in of_node(node)} - {"/parameter_events"})
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
    wait(lambda: current().stage.subscriptions(topic), arrival_timeout())  # a program's come after its node
    matched = wait(lambda: publisher.get_subscription_count() > 0, topics.MISMATCH_TIMEOUT)
    asked = [subscription.qos_profile for subscription in current().stage.subscriptions(topic)]
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


def publisher(topic: str, message_type: Any, qos: QoSProfile | int = 10) -> Publisher:
    """A publisher of the checker's on the stage."""
    return current().stage.check_node.create_publisher(message_type, topics.absolute(topic), qos)


def publish_steadily(to: Publisher, messages: Sequence[Any], period: float) -> None:
    """Publish messages one by one, `period` seconds apart, by the clock: what comes late is made up for."""
    due = time.monotonic()
    for message in messages:
        to.publish(message)
        due += period
        pause(max(0.0, due - time.monotonic()))


def listen(topic: str, message_type: Any) -> Heard:
    """Hear what the answer says on a topic of the stage from now on, until the check ends."""
    heard = current().stage.listen(topic, message_type)
    meet(current().stage, topic)
    return heard


def hear_the_turtle() -> Heard:
    """Hear the pose of turtle1 of a_turtle(), and what nobody else says of it, until the check ends."""
    heard = current().stage.listen("/turtle1/pose", Pose, own=True)
    wait(lambda: len(heard), MATCH_TIMEOUT, "the turtle's pose")
    return heard


def wait_until_quiet(heard: Heard, quiet: float, timeout: float, at_most: int = 1_000_000) -> None:
    """Wait until something has come and then nothing for `quiet` seconds, `at_most` messages, or the time is over."""

    def is_quiet() -> bool:
        times = heard.times
        return len(times) >= at_most or bool(times and time.time_ns() - times[-1] > quiet * 1e9)

    wait(is_quiet, timeout, f"the end of {heard.topic}")


def values(heard: Heard, field: str) -> list[Any]:
    """One field of all messages."""
    return [getattr(message, field) for message in heard.messages]


def rate(heard: Heard) -> float:
    """Messages a second, as `ros2 topic hz` has it; nan below two messages."""
    times = np.asarray(heard.times, np.int64)
    return measure(times, np.ones_like(times)).rate


def expect_rate(heard: Heard, wanted: float, within: float, points: int = 1, hint: str = "") -> bool:
    """The messages came at a rate (Hz), but for a part of it (`within`)."""
    measured = rate(heard)
    came = f"{len(heard)} message came, too few for a rate." if math.isnan(measured) else f"It was {measured:.1f} Hz."
    why = hint or f"The period is in seconds: 1 / {wanted:g} = {1 / wanted:g}."
    return expect(
        f"`{heard.topic}` has {wanted:g} messages a second",
        abs(measured - wanted) <= within * wanted,
        f"{came} {why} `%ros2 topic hz {heard.topic}` measures it.",
        points,
    )
