"""Records a fast topic of another process: `recorder plain|course string|scan DEPTH`.

`plain` keeps the messages in a list, in a subscription that rclpy.spin serves; `course` is record(). The command
`record RATE SECONDS` reports what was sent, at which rate, and how many messages were kept.
"""

from __future__ import annotations

import contextlib
import sys
import threading
import time
from collections.abc import Callable

import rclpy
from rclpy.executors import ExternalShutdownException
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String

from tests.benchmark.programs.reporting import report
from tests.senders import Sender

TYPES = {"string": String, "scan": LaserScan}
TOPIC = "/recorded"
QUIET = 0.5  # s without a message, after which none is under way


def main(style: str, kind: str, depth: str) -> None:
    if style == "plain":
        spin_plain(kind, int(depth))
    else:
        report(ready=True)
        obey(lambda sender: kept_by_course(sender, kind), kind, int(depth))


def obey(kept: Callable[[Sender], int], kind: str, depth: int) -> None:
    for line in sys.stdin:
        _, rate, seconds = line.split()
        count = int(float(rate) * float(seconds))
        with Sender(TOPIC, kind, rate=float(rate), count=count, depth=depth) as sender:
            received = kept(sender)
            result = sender.result()
        report(sent=result["sent"], rate=result["rate"], received=received)


def settled(count: Callable[[], int]) -> int:
    """Wait until messages came and no more do."""
    before, since, deadline = count(), time.monotonic(), time.monotonic() + 30
    while time.monotonic() < deadline and (not before or time.monotonic() < since + QUIET):
        time.sleep(0.05)
        if (now := count()) != before:
            before, since = now, time.monotonic()
    return before


def kept_by_course(sender: Sender, kind: str) -> int:
    from course_kit import record

    with record(TOPIC, TYPES[kind]) as recording:
        sender.go()
        return settled(lambda: len(recording))


def spin_plain(kind: str, depth: int) -> None:
    rclpy.init()
    node = rclpy.create_node("plain_recorder")
    messages: list[object] = []
    node.create_subscription(TYPES[kind], TOPIC, messages.append, depth)

    def kept(sender: Sender) -> int:
        messages.clear()
        sender.go()
        return settled(lambda: len(messages))

    def commands() -> None:
        obey(kept, kind, depth)
        rclpy.shutdown()

    threading.Thread(target=commands, daemon=True).start()
    report(ready=True)
    with contextlib.suppress(ExternalShutdownException):
        rclpy.spin(node)
    rclpy.try_shutdown()


if __name__ == "__main__":
    main(*sys.argv[1:])
