"""Counts the messages of a stream, without deserialising them: `stream_receiver KIND`.

Reports when it is ready, and for each line of input how many came since the last one, over how many seconds, and
the CPU seconds of this process.
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


def main(kind: str) -> None:
    rclpy.init()
    node = rclpy.create_node("stream_receiver")
    times: list[float] = []
    node.create_subscription(messages.TYPES[kind], "stream", lambda data: times.append(time.monotonic()), 10, raw=True)
    executor = EventsExecutor()
    executor.add_node(node)

    def answer() -> None:
        for _ in sys.stdin:
            got, cpu = times.copy(), time.process_time()
            times.clear()
            report(received=len(got), seconds=got[-1] - got[0] if got else 0.0, cpu=cpu)
        rclpy.shutdown()

    threading.Thread(target=answer, daemon=True).start()
    report(ready=True)
    with contextlib.suppress(ExternalShutdownException):
        while rclpy.ok():  # without a timeout an EventsExecutor runs nothing
            executor.spin_until_future_complete(Future(), timeout_sec=3600.0)
    rclpy.try_shutdown()


if __name__ == "__main__":
    main(sys.argv[1])
