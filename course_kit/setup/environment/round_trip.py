"""Sends one ROS 2 message from a node in one process to a node in another: proof that ROS 2 works here.

    python -m course_kit.setup.environment.round_trip 10

waits up to 10 s and prints {"rmw": name, "node": seconds, "message": seconds, or null if none came}.
"""

from __future__ import annotations

import json
import os
import select
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.utilities import get_rmw_implementation_identifier
from std_msgs.msg import String

from course_kit.base.polling import wait_until
from course_kit.ros.spinning import context

TOPIC = "/environment_check_{}"  # with the process id, so that two checks at once do not hear each other


def listen(timeout: float) -> dict[str, str | float | None]:
    """Start a node here and a talker in another process; wait for its first message."""
    begun = time.monotonic()
    context.start()
    node = Node("environment_check_listener")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    received: list[String] = []
    topic = TOPIC.format(os.getpid())
    node.create_subscription(String, topic, received.append, 10)
    started = time.monotonic()
    with _talker(topic):
        wait_until(lambda: received, timeout, 0.1, executor.spin_once)
    seconds = round(time.monotonic() - started, 2) if received else None
    return {"rmw": get_rmw_implementation_identifier(), "node": round(started - begun, 2), "message": seconds}


@contextmanager
def _talker(topic: str) -> Iterator[None]:
    command = [sys.executable, "-B", "-m", "course_kit.setup.environment.round_trip", topic]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL) as process:
        try:
            yield
        finally:
            assert process.stdin is not None
            process.stdin.close()  # it ends by itself, and leaves nothing in shared memory
            try:
                process.wait(5)
            except subprocess.TimeoutExpired:
                process.kill()


def talk(topic: str) -> None:
    """Publish every 50 ms until the listener closes our standard input."""
    context.start()
    publisher = Node("environment_check_talker").create_publisher(String, topic, 10)
    while not select.select([sys.stdin], [], [], 0.05)[0]:
        publisher.publish(String(data="hello"))


if __name__ == "__main__":
    if sys.argv[1].startswith("/"):
        talk(sys.argv[1])
    else:
        print(json.dumps(listen(float(sys.argv[1]))))
    context.stop()
