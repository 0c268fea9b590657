"""What checks say about topics: who publishes and subscribes, with which type and QoS, what comes, and how often."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from course_kit.examining.examination import now
from course_kit.examining.introduction import meet
from course_kit.examining.station import Heard
from course_kit.examining.vocabulary import nearest, pause, settle_timeout
from course_kit.recordings.measure import measure
from course_kit.watching import topics
from course_kit.watching.topics import type_name


def expect_topic(topic: str, message_type: Any) -> None:
    """The answer publishes a topic of this type."""
    _expect_end(topic, message_type, "publishes", "publisher", now().stage.publishers, lambda i: i.publishers)


def expect_subscription(topic: str, message_type: Any) -> None:
    """The answer subscribes to a topic with this type."""
    _expect_end(
        topic, message_type, "subscribes to", "subscription", now().stage.subscriptions, lambda i: i.subscribers
    )


def _expect_end(
    topic: str,
    message_type: Any,
    does: str,
    end: str,
    ends: Callable[[str], Sequence[Any]],
    of_node: Callable[[Any], dict[str, list[str]]],
) -> None:
    now().wait(lambda: ends(topic), settle_timeout())
    found = ends(topic)
    names = now().stage.their_nodes()
    theirs = sorted({name for one in now().stage.offered() for name in of_node(one)} - {"/parameter_events"})
    hint = f"`{topic}` has no {end}. "
    if not names:
        hint += "Is your node running? `%ros2 node list` shows it."
    elif theirs:
        hint += f"{nearest(topic, theirs)}Your node {does} {', '.join(theirs)}: `%ros2 node info {names[0]}` shows it."
    else:
        hint += f"Your node {does} no topic: `%ros2 node info {names[0]}` shows what it has."
    now().settle(f"it {does} `{topic}`", found, hint)
    wanted = type_name(message_type)
    types = sorted({one.topic_type for one in found})
    hint = (
        f"Its type is {', '.join(types)}. Ends of different types never meet, and nobody gets an error: "
        f"`%ros2 topic info {topic}` shows the type."
    )
    now().settle(f"`{topic}` has the type `{wanted}`", types == [wanted], hint)


def expect_compatible_subscription(topic: str, publisher: Publisher, points: int = 0) -> bool:
    """The answer's subscription takes what this publisher offers: they match."""
    now().wait(lambda: now().stage.subscriptions(topic), settle_timeout())  # a program's come after its node
    matched = now().wait(lambda: publisher.get_subscription_count() > 0, topics.MISMATCH_TIMEOUT)
    asked = [s.qos_profile for s in now().stage.subscriptions(topic)]
    why = "`%ros2 topic info -v` shows both sides."
    if any(q.reliability == ReliabilityPolicy.RELIABLE for q in asked):
        why = (
            "It asks for RELIABLE, and the publisher offers BEST_EFFORT only, so DDS does not connect them. "
            f"`%ros2 topic info -v {topic}` shows both sides."
        )
    elif any(q.durability == DurabilityPolicy.TRANSIENT_LOCAL for q in asked):
        why = (
            "It asks for TRANSIENT_LOCAL, and the publisher offers VOLATILE only, so DDS does not connect them. "
            f"`%ros2 topic info -v {topic}` shows both sides."
        )
    return now().settle(f"its subscription to `{topic}` matches the publisher's QoS", matched, why, points, needed=True)


def publisher(topic: str, message_type: Any, qos: QoSProfile | int = 10) -> Publisher:
    """A publisher of the checker's on the stage."""
    station = now().stage
    return station.hand.create_publisher(message_type, topics.absolute(topic), qos)


def publish_steadily(to: Publisher, messages: Sequence[Any], period: float) -> None:
    """Publish messages one by one, `period` seconds apart, by the clock: what comes late is made up for."""
    due = time.monotonic()
    for message in messages:
        to.publish(message)
        due += period
        pause(max(0.0, due - time.monotonic()))


def listen(topic: str, message_type: Any) -> Heard:
    """Hear a topic of the stage from now on, until the check ends."""
    heard = now().stage.listen(topic, message_type)
    meet(now().stage)
    return heard


def wait_until_quiet(heard: Heard, quiet: float, timeout: float, at_most: int = 1_000_000) -> None:
    """Wait until something has come and then nothing for `quiet` seconds, `at_most` messages, or the time is over."""

    def is_quiet() -> bool:
        times = heard.times
        return len(times) >= at_most or bool(times and time.time_ns() - times[-1] > quiet * 1e9)

    now().wait(is_quiet, timeout, f"the end of {heard.subscription.topic if heard.subscription else 'a topic'}")


def values(heard: Heard, field: str) -> list[Any]:
    """One field of all messages."""
    return [getattr(message, field) for message in heard.messages]


def rate(heard: Heard) -> float:
    """Messages a second, as `ros2 topic hz` has it; nan below two messages."""
    import numpy as np

    times = np.asarray(heard.times, np.int64)
    return measure(times, np.ones_like(times)).rate


def expect_rate(heard: Heard, wanted: float, within: float, points: int, hint: str = "") -> bool:
    """The messages came at a rate (Hz), but for a part of it (`within`)."""
    measured = rate(heard)
    topic = heard.subscription.topic if heard.subscription else ""
    was = f"It was {measured:.1f} Hz." if measured == measured else f"{len(heard)} message came, too few for a rate."
    return now().settle(
        f"`{topic}` has {wanted:g} messages a second",
        abs(measured - wanted) <= within * wanted,
        f"{was} {hint or f'The period is in seconds: 1 / {wanted:g} = {1 / wanted:g}.'} `%ros2 topic hz "
        f"{topic}` measures it.",
        points,
    )
