"""`ros2 topic pub`: publish a message that is written as YAML."""

from __future__ import annotations

import time
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from contextlib import contextmanager
from queue import SimpleQueue
from typing import Any

from course_kit.ros2.completion import names_of, type_of
from course_kit.ros2.session import Session
from course_kit.ros2.topic import endpoints
from course_kit.ros2.verbs import (
    CommandError,
    Verb,
    add_duration_argument,
    add_flag,
    add_node_arguments,
    add_offered,
    did_you_mean,
)

MATCH_TIME = 0.2  # seconds in which subscriptions that are known are matched, before the user is told of a wait
REMIND_PERIOD = 1.0  # seconds between two lines while it waits


def nonnegative_int(text: str) -> int:
    """A type of argparse, whose message names the function."""
    value = int(text)
    if value < 0:
        raise ValueError
    return value


def _arguments(parser: ArgumentParser) -> None:
    add_offered(parser, "topic_name", names_of("topic"), "Name of the ROS topic to publish to (e.g. '/chatter')")
    add_offered(parser, "message_type", type_of("topic"), "Type of the ROS message (e.g. 'std_msgs/String')")
    group = parser.add_mutually_exclusive_group()
    group.add_argument(
        "values",
        nargs="?",
        default="{}",
        help="Values to fill the message with in YAML format (e.g. 'data: Hello World'), otherwise the message will "
        "be published with default values. A time may be 'now' and a std_msgs/Header 'auto', which is one with the "
        "current time.",
    )
    add_flag(group, "--stdin", "Read values from standard input")
    parser.add_argument(
        "-r",
        "--rate",
        metavar="N",
        type=endpoints.positive_float,
        default=1.0,
        help="Publishing rate in Hz (default: 1)",
    )
    parser.add_argument(
        "-p",
        "--print",
        metavar="N",
        type=int,
        default=1,
        help="Only print every N-th published message (default: 1)",
    )
    group = parser.add_mutually_exclusive_group()
    add_flag(group, "-1 --once", "Publish one message and exit")
    group.add_argument(
        "-t", "--times", type=nonnegative_int, default=0, help="Publish this number of times and then exit"
    )
    parser.add_argument(
        "-w",
        "--wait-matching-subscriptions",
        type=nonnegative_int,
        default=None,
        help="Wait until finding the specified number of matching subscriptions. Defaults to 1 when using "
        '"-1"/"--once"/"--times", otherwise defaults to 0.',
    )
    parser.add_argument(
        "--max-wait-time-secs",
        type=endpoints.positive_float,
        default=None,
        help="This sets the maximum wait time in seconds if --wait-until-matching-subscriptions is set. By default, "
        "this flag is not set meaning the subscriber will wait endlessly.",
    )
    parser.add_argument(
        "--keep-alive",
        metavar="N",
        type=endpoints.positive_float,
        default=0.1,
        help="Keep publishing node alive for N seconds after the last msg (default: 0.1)",
    )
    parser.add_argument("-n", "--node-name", help="Name of the created publishing node")
    endpoints.add_qos_arguments(parser, "publish", "default")
    add_node_arguments(parser)
    add_duration_argument(parser)


def _run(args: Namespace, session: Session) -> None:
    from course_kit.ros2.messages.arguments import filled, interface_class, parsed

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
    with _publisher(session, args, topic, kind) as (publisher, clock, warnings):
        _wait_for_subscriptions(session, topic, publisher, wanted, args.max_wait_time_secs)
        session.print("publisher: beginning loop")
        _publish(session, args, publisher, clock, message, times, count, warnings)
        session.sleep(args.keep_alive)
        _warn(session, warnings)


@contextmanager
def _publisher(session: Session, args: Namespace, topic: str, kind: Any) -> Iterator[tuple[Any, Any, SimpleQueue[str]]]:
    """A publisher, the clock for its stamps and what there is to warn of, while the block runs."""
    from rclpy.event_handler import PublisherEventCallbacks

    from course_kit.watching import instruments

    warnings: SimpleQueue[str] = SimpleQueue()
    qos = endpoints.chosen(args)
    session.graph()  # so that who listens is matched at once
    with _node(session, args) as node:

        def note_mismatch(event: Any) -> None:
            name = node.get_name()
            warnings.put(endpoints.incompatible(name, topic, event.last_policy_kind, is_publisher=True))

        events = PublisherEventCallbacks(incompatible_qos=note_mismatch)
        try:
            publisher = node.create_publisher(kind, topic, qos, event_callbacks=events)
        except Exception as error:  # rclpy has several for what the middleware refuses
            raise endpoints.refused(error, topic) from None
        try:
            yield publisher, node.get_clock(), warnings
        finally:
            instruments.executor().create_task(node.destroy_publisher, publisher)


@contextmanager
def _node(session: Session, args: Namespace) -> Iterator[Any]:
    """The node that publishes: the session's, or one of its own if it needs a name or simulation time."""
    if args.node_name is None and not args.use_sim_time:
        yield session.node
        return
    from rclpy.exceptions import InvalidNodeNameException
    from rclpy.validate_node_name import validate_node_name

    from course_kit.spinning.nodes import quiet_node
    from course_kit.watching import instruments

    executor = instruments.executor()
    name = args.node_name or f"{session.node.get_name()}_publisher"
    try:
        validate_node_name(name)
    except InvalidNodeNameException as error:
        raise CommandError(str(error).split("\n")[0].rstrip(":")) from None
    node = quiet_node(name, with_rosout=True, use_sim_time=args.use_sim_time)
    executor.add_node(node)
    try:
        yield node
    finally:

        def destroy() -> None:
            executor.remove_node(node)
            node.destroy_node()

        executor.create_task(destroy)


def _wait_for_subscriptions(session: Session, topic: str, publisher: Any, wanted: int, limit: float | None) -> None:
    def are_matched() -> bool:
        return bool(publisher.get_subscription_count() >= wanted)

    began = time.monotonic()
    if session.until(are_matched, MATCH_TIME):
        return
    if suggestion := _listened_to(session, topic):
        session.warn(suggestion)
    while True:
        session.print(f"Waiting for at least {wanted} matching subscription(s)...")
        left = REMIND_PERIOD if limit is None else min(REMIND_PERIOD, began + limit - time.monotonic())
        if session.until(are_matched, max(0.0, left)):
            return
        if limit is not None and time.monotonic() >= began + limit:
            raise CommandError(
                f"Timed out waiting for subscribers: Expected {wanted} subcribers but only got "
                f"{publisher.get_subscription_count()} subscribers"
            )


def _listened_to(session: Session, topic: str) -> str | None:
    """A suggestion if nobody but this publisher knows the topic."""
    node = session.node
    if node.count_subscribers(topic):
        return None
    return did_you_mean(topic, (n for n, _ in node.get_topic_names_and_types() if node.count_subscribers(n)))


def _publish(
    session: Session,
    args: Namespace,
    publisher: Any,
    clock: Any,
    message: Any,
    times: list[Any],
    count: int,
    warnings: SimpleQueue[str],
) -> None:
    """Publish at the rate asked for: `count` times, or for ever if it is 0."""
    from course_kit.ros2.messages.values import stamp

    period, sent, due = 1 / args.rate, 0, time.monotonic()
    while count == 0 or sent < count:
        session.sleep(due - time.monotonic())
        _warn(session, warnings)
        stamp(times, *clock.now().seconds_nanoseconds())
        sent += 1
        if args.print and sent % args.print == 0:
            session.print(f"publishing #{sent}: {message!r}\n")
        publisher.publish(message)
        due = max(due + period, time.monotonic() - period)  # after a stall it does not hurry to catch up


def _warn(session: Session, warnings: SimpleQueue[str]) -> None:
    while not warnings.empty():
        session.warn(warnings.get())


PUB = Verb("Publish a message to a topic", _run, _arguments)
