"""`ros2 doctor hello`: says hello on a topic and by UDP multicast, and counts which other machines do so too."""

from __future__ import annotations

import os
import re
import socket
import time
from argparse import Namespace
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from queue import SimpleQueue
from typing import Any

from course_kit.cli.ros2.session import Session
from course_kit.cli.ros2.verbs import Verb, argument, duration, flag, number, positive_float

GROUP, PORT = "225.0.0.1", 49150  # those of the real command
RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
LONGEST_DATAGRAM = 4096  # bytes


def _hello(args: Namespace, session: Session) -> None:
    from course_kit.cli.ros2.messages.arguments import checked_name

    topic, host = checked_name(args.topic, "topic"), socket.gethostname()
    name = f"ros2doctor_{re.sub('[^0-9a-zA-Z_]', '_', host)}_{os.getpid()}_node"
    if os.environ.get(RANGE) in ("LOCALHOST", "OFF"):
        session.warn(
            f"{RANGE}={os.environ[RANGE]} keeps nodes of other machines away: SUBNET lets them hear each other"
        )
    with ExitStack() as stack:
        said_on_topic: SimpleQueue[str] = SimpleQueue()
        say = _on_topic(stack.enter_context(session.own_node(name)), topic, said_on_topic)
        multicast = Multicast(session, args.ttl)
        stack.callback(multicast.close)
        emit, show = time.monotonic(), time.monotonic() + args.print_period
        published, sent = 0, 0
        while True:
            if time.monotonic() >= emit:
                say(f"hello, it's me {host}")
                published += 1
                sent += multicast.send(f"hello, it's me {host}")
                emit = max(emit + args.emit_period, time.monotonic())  # after a stall it does not hurry to catch up
            session.sleep(min(emit, show) - time.monotonic())
            if args.once or time.monotonic() >= show:
                heard = [_hosts(session.items(said_on_topic, 0.0), host), _hosts(multicast.received(), host)]
                session.print(summary(topic, args.print_period, published, sent, *heard))
                show, published, sent = show + args.print_period, 0, 0
            if args.once:
                return


def _on_topic(node: Any, topic: str, heard: SimpleQueue[str]) -> Any:
    """A function that publishes a text; what comes, also of oneself, goes into the queue."""
    from rclpy.qos import qos_profile_system_default
    from std_msgs.msg import String

    from course_kit.cli.ros2.topic.endpoints import refused

    with refused(topic):
        publisher = node.create_publisher(String, topic, qos_profile_system_default)
        node.create_subscription(String, topic, lambda message: heard.put(message.data), qos_profile_system_default)
    return lambda text: publisher.publish(String(data=text))


class Multicast:
    """Sends and receives texts by UDP multicast. What a machine without multicast refuses is said once."""

    def __init__(self, session: Session, ttl: int | None) -> None:
        self._session, self._has_warned = session, False
        self._out, self._in = (socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2))
        if ttl is not None:
            self._out.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, ttl)
        self._in.setblocking(False)
        for shared in (socket.SO_REUSEADDR, socket.SO_REUSEPORT):
            self._in.setsockopt(socket.SOL_SOCKET, shared, 1)
        try:
            self._in.bind(("", PORT))
            membership = socket.inet_aton(GROUP) + socket.inet_aton("0.0.0.0")
            self._in.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)
        except OSError as error:
            self._warn("received", error)

    def _warn(self, what: str, error: OSError) -> None:
        if not self._has_warned:
            self._session.warn(f"Nothing can be {what} by multicast on this machine: {error.strerror}")
        self._has_warned = True

    def send(self, text: str) -> bool:
        """Return True if the text was sent."""
        try:
            self._out.sendto(text.encode(), (GROUP, PORT))
        except OSError as error:
            self._warn("sent", error)
            return False
        return True

    def received(self) -> Iterator[str]:
        """The texts that have come by now, also those of oneself."""
        while True:
            try:
                yield self._in.recv(LONGEST_DATAGRAM).decode(errors="replace")
            except OSError:  # no more for now
                return

    def close(self) -> None:
        """Send and receive no more."""
        self._out.close()
        self._in.close()


def _hosts(texts: Iterator[str], own: str) -> Counter[str]:
    """How many texts came from each other machine, which is named by their last word."""
    return Counter(words[-1] for text in texts if (words := text.split()) and words[-1] != own)


def summary(
    topic: str, period: float, published: int, sent: int, subscribed: Mapping[str, int], received: Mapping[str, int]
) -> str:
    """The table of one period."""
    row = "{:<15} {:<20} {:<10}".format

    def table(counts: Mapping[str, int]) -> list[str]:
        return [row("", "Hostname", f"Msg Count /{period}s"), *(row("", *pair) for pair in counts.items())]

    return "\n".join(
        [
            "MULTIMACHINE COMMUNICATION SUMMARY",
            f"Topic: {topic}, Published Msg Count: {published}",
            "Subscribed from:",
            *table(subscribed),
            f"Multicast Group/Port: {GROUP}/{PORT}, Sent Msg Count: {sent}",
            "Received from:",
            *table(received),
            "-" * 60,
        ]
    )


_ttl = number(int, lambda value: value > 0, "value must be a positive int", 255)
HELLO = Verb(
    "say hello to other machines, and count the answers",
    _hello,
    argument("-t --topic", "the topic of the hello (default: /canyouhearme)", default="/canyouhearme"),
    argument(
        "-ep --emit-period",
        "the seconds between two hellos (default: 0.1)",
        metavar="N",
        type=positive_float,
        default=0.1,
    ),
    argument(
        "-pp --print-period",
        "the seconds that a table covers (default: 1)",
        metavar="N",
        type=positive_float,
        default=1.0,
    ),
    argument("--ttl", "the number of routers that a datagram may pass (default: the system's)", metavar="N", type=_ttl),
    flag("-1 --once", "say it once, print the table and end"),
    duration,
)
