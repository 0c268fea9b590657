"""`ros2 topic pub`: publish a message that is written as YAML."""

from __future__ import annotations

import itertools
import math
import time
from argparse import Namespace
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from queue import SimpleQueue
from typing import Any

from course_kit.cli.ros2.completion import fields_of
from course_kit.cli.ros2.named import TOPICS
from course_kit.cli.ros2.session import Session
from course_kit.cli.ros2.topic import clock, endpoints
from course_kit.cli.ros2.verbs import (
    NODE,
    CommandError,
    Verb,
    argument,
    did_you_mean,
    duration,
    flag,
    number,
    one_of,
    positive_float,
    whole,
    yaml_values,
)

MATCH_TIME = 0.2  # seconds in which subscriptions that are known are matched, before the user is told of a wait
SIMULATED_POLL = 0.001  # seconds between two looks at the simulated clock
REMIND_PERIOD = 1.0  # seconds between two lines while it waits

_count = number(int, lambda value: value >= 0, "invalid nonnegative_int value: {!r}")


def _run(args: Namespace, session: Session) -> None:
    from course_kit.cli.ros2.messages.arguments import filled, interface_class, parsed
    from course_kit.cli.ros2.messages.values import stamp

    kind = interface_class(args.message_type, "msg")
    topic = endpoints.full_name(args.topic_name)
    message = kind()
    values = parsed(args, args.values, "The passed value needs to be in YAML string or a dictionary")
    if not isinstance(values, dict):
        raise CommandError("The passed value needs to be a dictionary in YAML format")
    times = filled(message, values)
    count = 1 if args.once else args.times
    wanted = int(count != 0) if args.wait_matching_subscriptions is None else args.wait_matching_subscriptions
    if wanted == 0 and args.max_wait_time_secs is not None:
        raise CommandError(
            "--max-wait-time-secs option is only effective with --wait-matching-subscriptions, --once or --times"
        )
    warnings: SimpleQueue[str] = SimpleQueue()
    with _node(session, args) as node, _publisher(session, args, node, topic, kind, warnings) as publisher:
        _wait_for_subscriptions(session, topic, publisher, wanted, args.max_wait_time_secs or math.inf)
        session.print("publisher: beginning loop")
        for sent in _turns(session, args, node):
            session.warn_of(warnings)
            stamp(times, *node.get_clock().now().seconds_nanoseconds())
            if args.print and sent % args.print == 0:
                session.print(f"publishing #{sent}: {message!r}\n")
            publisher.publish(message)
            if sent == count:
                break
        session.sleep(args.keep_alive)
        session.warn_of(warnings)


def _turns(session: Session, args: Namespace, node: Any) -> Iterator[int]:
    """Counts up: at once, then with the rate, on simulated time if that is wanted."""
    simulated, period = clock.of_node(node), 1 / args.rate
    now = (lambda: simulated.now() * 1e-9) if args.use_sim_time else time.monotonic
    due = now()
    for turn in itertools.count(1):
        if args.use_sim_time:
            session.until(lambda: not due - period <= now() < due, poll=SIMULATED_POLL)  # noqa: B023
        else:
            session.sleep(due - now())
        yield turn
        due += period
        if not args.use_sim_time:
            due = max(due, now() - period)  # after a stall it does not hurry to catch up
        elif not 0 < due - now() <= period:  # the simulation was set forward, as at the first message, or back
            due = now() + period


@contextmanager
def _publisher(
    session: Session, args: Namespace, node: Any, topic: str, kind: Any, warnings: SimpleQueue[str]
) -> Iterator[Any]:
    """A publisher while the block runs."""
    from rclpy.event_handler import PublisherEventCallbacks

    def note_mismatch(event: Any) -> None:
        warnings.put(endpoints.incompatible(node.get_name(), topic, event.last_policy_kind, is_publisher=True))

    qos, events = endpoints.chosen(args), PublisherEventCallbacks(incompatible_qos=note_mismatch)
    session.graph()  # so that who listens is matched at once
    with endpoints.refused(topic):
        publisher = node.create_publisher(kind, topic, qos, event_callbacks=events)
    try:
        yield publisher
    finally:
        node.executor.create_task(node.destroy_publisher, publisher)


def _node(session: Session, args: Namespace) -> AbstractContextManager[Any]:
    """The node that publishes: the session's, or one of its own if it needs a name or simulation time."""
    from course_kit.cli.ros2.messages.arguments import checked_node_name

    if args.node_name is None and not args.use_sim_time:
        return nullcontext(session.node)
    name = f"{session.node.get_name()}_publisher" if args.node_name is None else args.node_name
    return session.own_node(checked_node_name(name), with_rosout=True, use_sim_time=args.use_sim_time)


def _wait_for_subscriptions(session: Session, topic: str, publisher: Any, wanted: int, limit: float) -> None:
    def are_matched() -> bool:
        return bool(publisher.get_subscription_count() >= wanted)

    if session.until(are_matched, MATCH_TIME):
        return
    if suggestion := _listened_to(session, topic):
        session.warn(suggestion)
    while True:
        session.print(f"Waiting for at least {wanted} matching subscription(s)...")
        if session.until(are_matched, min(REMIND_PERIOD, limit)):
            return
        if limit < REMIND_PERIOD:
            raise CommandError(
                f"Timed out waiting for subscribers: Expected {wanted} subcribers but only got "
                f"{publisher.get_subscription_count()} subscribers"
            )
        limit -= REMIND_PERIOD


def _listened_to(session: Session, topic: str) -> str | None:
    """A suggestion if nobody but this publisher knows the topic."""
    node = session.node
    if node.count_subscribers(topic):
        return None
    return did_you_mean(topic, (n for n, _ in node.get_topic_names_and_types() if node.count_subscribers(n)))


PUB = Verb(
    "publish a message written as YAML, once or again and again",
    _run,
    TOPICS.name,
    TOPICS.typed("message_type"),
    yaml_values("values", "{linear: {x: 2.0}}", fields_of("msg", "message_type")),
    argument("-r --rate", "the rate in Hz (default: 1)", metavar="N", type=positive_float, default=1.0),
    argument("-p --print", "print every Nth message, 0 for none (default: 1)", metavar="N", type=whole, default=1),
    one_of(
        flag("-1 --once", "publish one message and end"),
        argument("-t --times", "publish it N times and end", type=_count, default=0),
    ),
    argument(
        "-w --wait-matching-subscriptions",
        "wait for N subscriptions (default: 1 with --once and --times, else 0)",
        type=_count,
    ),
    argument("--max-wait-time-secs", "wait at most N seconds for them (default: for ever)", type=positive_float),
    argument(
        "--keep-alive",
        "stay for N seconds after the last message (default: 0.1)",
        metavar="N",
        type=positive_float,
        default=0.1,
    ),
    argument("-n --node-name", "the name of the publishing node"),
    endpoints.qos_options("default"),
    NODE,
    duration,
)
