"""Publishes serialised messages at a steady rate: `stream_sender KIND DEPTH`.

The command `send RATE SECONDS` reports how many were sent, and at which rate.
"""

from __future__ import annotations

import sys
import time

import rclpy
from rclpy.publisher import Publisher
from rclpy.serialization import serialize_message

from tests.benchmark.programs import messages
from tests.benchmark.programs.reporting import report

MATCH_TIMEOUT = 15.0
PAUSE = 0.0005


def main(kind: str, depth: str) -> None:
    rclpy.init()
    node = rclpy.create_node("stream_sender")
    publisher = node.create_publisher(messages.TYPES[kind], "stream", int(depth))
    serialised = serialize_message(messages.template(kind))
    deadline = time.monotonic() + MATCH_TIMEOUT
    while not publisher.get_subscription_count():
        if time.monotonic() > deadline:
            raise SystemExit(f"no receiver within {MATCH_TIMEOUT:g} s")
        time.sleep(0.01)
    time.sleep(0.5)  # the receiver may match later than the sender
    report(ready=True)
    for line in sys.stdin:
        _, rate, seconds = line.split()
        sent, really = send(publisher, serialised, float(rate), float(seconds))
        report(sent=sent, rate=really)
    node.destroy_node()
    rclpy.shutdown()


def send(publisher: Publisher, serialised: bytes, rate: float, seconds: float) -> tuple[int, float]:
    """Publish for a time; gives how many, and the rate that was kept."""
    began = time.monotonic()
    sent, passed = 0, 0.0
    while passed < seconds:
        while sent < passed * rate:
            publisher.publish(serialised)
            sent += 1
        time.sleep(PAUSE)
        passed = time.monotonic() - began
    return sent, sent / passed


if __name__ == "__main__":
    main(*sys.argv[1:])
