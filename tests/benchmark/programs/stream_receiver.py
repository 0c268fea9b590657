"""Counts the messages of a stream, without deserialising them: `stream_receiver KIND DEPTH`.

Each line of input is answered with how many came since the last one, once no more do.
"""

from __future__ import annotations

import contextlib
import sys
import threading
import time

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.experimental import EventsExecutor
from rclpy.task import Future

from tests.benchmark.programs import messages
from tests.benchmark.programs.reporting import report

QUIET = 0.2  # s without a message, after which none is under way


def main(kind: str, depth: str) -> None:
    rclpy.init()
    node = rclpy.create_node("stream_receiver")
    times: list[float] = []

    def hear(data: bytes) -> None:
        times.append(time.monotonic())

    node.create_subscription(messages.TYPES[kind], "stream", hear, int(depth), raw=True)
    executor = EventsExecutor()
    executor.add_node(node)

    def answer() -> None:
        for _ in sys.stdin:
            while times and time.monotonic() < times[-1] + QUIET:
                time.sleep(0.02)
            report(count=len(times))
            times.clear()
        rclpy.shutdown()

    threading.Thread(target=answer, daemon=True).start()
    report(ready=True)
    with contextlib.suppress(ExternalShutdownException):
        while rclpy.ok():  # without a timeout an EventsExecutor runs nothing
            executor.spin_until_future_complete(Future(), timeout_sec=3600.0)
    rclpy.try_shutdown()


if __name__ == "__main__":
    main(*sys.argv[1:])
