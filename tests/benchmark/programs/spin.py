"""A talker and a listener, spun by plain rclpy or by the course: `spin plain|course both|talker|listener KIND DEPTH`.

Commands, one a line: `talk RATE SECONDS` publishes stamped messages and reports how many; `heard` reports how many
messages came since the last time, and their latencies in µs. Nothing of course_kit is imported for `plain`.
"""

from __future__ import annotations

import contextlib
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node

from tests.benchmark.programs import messages
from tests.benchmark.programs.reporting import report

MATCH_TIMEOUT = 15.0
SLOWEST_TICK = 500.0  # Hz: at higher rates a tick of the timer publishes several messages, above FASTEST_SINGLE
FASTEST_SINGLE = 1000.0  # Hz
QUIET = 0.3  # s without a message, after which none is under way


class Talker(Node):
    """Publishes at a rate for a time."""

    def __init__(self, kind: str, depth: int) -> None:
        super().__init__("talker")
        self._publisher = self.create_publisher(messages.TYPES[kind], "spoken", depth)
        self._message = messages.template(kind)
        self._sent = 0

    def _publish(self, end: float, burst: int) -> None:
        if time.monotonic() > end:
            self.destroy_timer(self._timer)
            return
        for _ in range(burst):
            messages.stamp(self._message, self._sent)
            self._publisher.publish(self._message)
            self._sent += 1

    def talk(self, rate: float, seconds: float) -> dict[str, float]:
        """Publish; called from a thread that does not spin."""
        deadline = time.monotonic() + MATCH_TIMEOUT
        while not self._publisher.get_subscription_count():
            if time.monotonic() > deadline:
                raise SystemExit(f"no listener within {MATCH_TIMEOUT:g} s")
            time.sleep(0.01)
        burst = 1 if rate <= FASTEST_SINGLE else round(rate / SLOWEST_TICK)
        before, began = self._sent, time.monotonic()
        self._timer = self.create_timer(burst / rate, lambda: self._publish(began + seconds, burst))
        time.sleep(seconds + 2 * burst / rate)
        sent = self._sent - before
        return {"sent": sent, "rate": sent / seconds}


class Listener(Node):
    """Keeps the latency of each message."""

    def __init__(self, kind: str, depth: int) -> None:
        super().__init__("listener")
        self._latencies: list[int] = []
        self._last = 0.0
        self.create_subscription(messages.TYPES[kind], "spoken", self._hear, depth)

    def _hear(self, message: Any) -> None:
        self._latencies.append(messages.read(message)[1])
        self._last = time.monotonic()

    def heard(self) -> dict[str, Any]:
        """What came until now; waits for what is under way."""
        while time.monotonic() < self._last + QUIET:
            time.sleep(0.05)
        latencies = sorted(self._latencies)
        self._latencies.clear()
        if not latencies:
            return {"count": 0, "median": None, "p99": None}
        return {
            "count": len(latencies),
            "median": latencies[len(latencies) // 2] / 1000,
            "p99": latencies[len(latencies) * 99 // 100] / 1000,
        }


def spin_plain(classes: list[Callable[..., Node]], arguments: tuple[str, int]) -> list[Node]:
    """As in a script: rclpy.spin in the main thread, all nodes in the one global executor."""
    rclpy.init()
    made = [cls(*arguments) for cls in classes]
    for node in made[1:]:
        rclpy.get_global_executor().add_node(node)
    return made


def spin_course(classes: list[Callable[..., Node]], arguments: tuple[str, int]) -> list[Node]:
    """As in a notebook: run() each of them."""
    from course_kit import run

    return [run(cls, *arguments) for cls in classes]


def main(style: str, role: str, kind: str, depth: str) -> None:
    roles: dict[str, list[Callable[..., Node]]] = {
        "both": [Talker, Listener],
        "talker": [Talker],
        "listener": [Listener],
    }
    nodes = (spin_plain if style == "plain" else spin_course)(roles[role], (kind, int(depth)))

    def obey() -> None:
        for line in sys.stdin:
            command, *values = line.split()
            node = next(node for node in nodes if hasattr(node, command))
            report(**getattr(node, command)(*map(float, values)))

    report(ready=True)
    if style == "course":
        obey()
        return

    def commands() -> None:
        obey()
        rclpy.shutdown()

    threading.Thread(target=commands, daemon=True).start()
    with contextlib.suppress(ExternalShutdownException):
        rclpy.spin(nodes[0])
    rclpy.try_shutdown()


if __name__ == "__main__":
    main(*sys.argv[1:])
