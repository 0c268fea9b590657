"""Publishes serialised messages as fast as it can: `stream_sender KIND SECONDS`; reports how many."""

from __future__ import annotations

import sys
import time

import rclpy
from rclpy.serialization import serialize_message

from tests.benchmark.programs import messages
from tests.benchmark.programs.reporting import report

MATCH_TIMEOUT = 15.0


def main(kind: str, seconds: float) -> None:
    rclpy.init()
    node = rclpy.create_node("stream_sender")
    publisher = node.create_publisher(messages.TYPES[kind], "stream", 10)
    serialised = serialize_message(messages.template(kind))
    deadline = time.monotonic() + MATCH_TIMEOUT
    while not publisher.get_subscription_count():
        if time.monotonic() > deadline:
            raise SystemExit("no receiver within 15 s")
        time.sleep(0.01)
    time.sleep(0.3)  # the receiver may match later than the sender
    sent = 0
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        publisher.publish(serialised)
        sent += 1
    time.sleep(0.3)  # a writer that is destroyed takes its last messages with it
    report(sent=sent)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]))
