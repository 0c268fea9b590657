"""Publishers in processes of their own, for tests: `with Sender('/scan', 'scan', rate=5000, count=10_000) as sender`.

Run as a program it publishes numbered, pre-serialised messages at a steady rate, when it is told to.
"""

from __future__ import annotations

import json
import subprocess
import sys
import threading
import time
from typing import Any

DIGITS = 12  # of the number that each message carries, at a fixed place in its bytes
PLACES = {"string": 8, "scan": 16}


class Sender:
    """A publisher process; it is there, and its publisher too, when the `with` block begins.

    Its history is deep, so that a busy machine delays messages but does not lose them.
    """

    def __init__(
        self,
        topic: str,
        kind: str = "string",
        rate: float = 100.0,
        count: int = 100,
        depth: int = 20_000,
        qos: str = "reliable",
    ) -> None:
        arguments = [topic, kind, str(rate), str(count), str(depth), qos]
        self._process = subprocess.Popen(
            [sys.executable, __file__, *arguments], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def __enter__(self) -> Sender:
        assert self._read() == "ready"
        return self

    def __exit__(self, *_: object) -> None:
        """End it in good order: a node that is killed stays in the graph for 20 s."""
        try:
            self._process.communicate(timeout=10)  # closes its input, which ends it
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.communicate()

    def _read(self) -> str:
        assert self._process.stdout is not None
        return self._process.stdout.readline().strip()

    def go(self, subscriptions: int = 1) -> None:
        """Let it publish; it waits for so many subscriptions first."""
        assert self._process.stdin is not None
        self._process.stdin.write(f"{subscriptions}\n")
        self._process.stdin.flush()

    def result(self) -> dict[str, Any]:
        """Wait for the last message to be sent: {'sent': messages, 'rate': Hz really sent, 'size': bytes of each}."""
        result: dict[str, Any] = json.loads(self._read())
        return result


def _main(topic: str, kind: str, rate: float, count: int, depth: int, qos: str) -> None:
    import rclpy
    from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
    from rclpy.serialization import serialize_message
    from sensor_msgs.msg import LaserScan
    from std_msgs.msg import Int32, String
    from turtlesim.msg import Pose

    rclpy.init()
    node = rclpy.create_node(f"sender_of_{kind}")
    if kind == "scan":
        message: Any = LaserScan(ranges=[0.01 * i for i in range(360)])
        message.header.frame_id = "0" * DIGITS
    else:
        message = {"string": String(data="0" * DIGITS), "pose": Pose(x=1.0), "int": Int32()}[kind]
    profile = QoSProfile(
        depth=depth,
        reliability=ReliabilityPolicy.BEST_EFFORT if qos == "best_effort" else ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if qos == "latched" else DurabilityPolicy.VOLATILE,
    )
    publisher = node.create_publisher(type(message), topic, profile)
    payload = bytearray(serialize_message(message))
    place = PLACES.get(kind)
    print("ready", flush=True)
    ended = threading.Event()

    def end_with_input() -> None:
        sys.stdin.readline()
        ended.set()

    if subscriptions := sys.stdin.readline():
        threading.Thread(target=end_with_input, daemon=True).start()
    else:
        ended.set()
    while not ended.is_set() and qos != "latched" and publisher.get_subscription_count() < int(subscriptions):
        time.sleep(0.005)
    start, sent = time.perf_counter(), 0
    last = start
    while sent < count and not ended.is_set():
        due = min(count, int((time.perf_counter() - start) * rate) + 1)
        while sent < due:
            if place is not None:
                payload[place : place + DIGITS] = b"%0*d" % (DIGITS, sent)
            publisher.publish(bytes(payload))
            sent += 1
            last = time.perf_counter()
        time.sleep(max(0.0, min(0.01, start + sent / rate - time.perf_counter())))
    really = (sent - 1) / (last - start) if sent > 1 else 0.0
    print(json.dumps({"sent": sent, "rate": really, "size": len(payload)}), flush=True)
    ended.wait()  # so that what was sent still reaches everybody
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    _main(sys.argv[1], sys.argv[2], float(sys.argv[3]), int(sys.argv[4]), int(sys.argv[5]), sys.argv[6])
