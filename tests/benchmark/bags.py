"""Bags: how many messages a second `ros2 bag record` takes without loss, how evenly `ros2 bag play` gives them out."""

from __future__ import annotations

import os
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path

from tests.benchmark.ceiling import CEILING, KEPT, highest_rate
from tests.benchmark.child import environment
from tests.benchmark.table import Row, at_least, at_most
from tests.domains import reserve_domain
from tests.senders import Sender

DEPTH = 5000
AIM = 1000  # messages a second
PLAY_RATE = 100  # Hz
QUIET = 0.5  # seconds after the last message was sent
NOTE = (
    f"bags: recorded: {CEILING}. The sender is another process and publishes serialised LaserScan(360) (reliable, "
    f"depth {DEPTH}), `ros2 bag record` is a process as in a terminal, and what its bag holds in the end is counted. "
    f"played: `ros2 bag play` of a bag with a message every {1000 // PLAY_RATE} ms; jitter is how far each message's "
    "time of receipt, taken by the middleware of another process, is from the time that the bag gives it, when the "
    "median of these differences is taken as the start."
)


def rows(quick: bool) -> Iterator[Row]:
    """All rows of this section."""
    for storage in ("mcap", "sqlite3"):
        found = []
        for repetition in range(1 if quick else 2):
            print(f"\rbags: {storage}, {repetition + 1} ", end="", file=sys.stderr)
            found.append(highest_rate(partial(_held, storage, 1.0 if quick else 2.0)))
        print(file=sys.stderr)
        what = f"recorded into {storage} without loss, LaserScan(360)"
        yield at_least(what, "messages/s", statistics.median(found), AIM)
    late = _played(3.0 if quick else 20.0)
    yield at_most(f"played at {PLAY_RATE} Hz: jitter, median", "ms", statistics.median(late), 1.0)
    yield at_most(f"played at {PLAY_RATE} Hz: jitter, 99 % below", "ms", late[int(0.99 * len(late))], 5.0)


def _ros2(*words: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [os.path.join(os.path.dirname(sys.executable), "ros2"), "bag", *words],
        env=environment(int(os.environ["ROS_DOMAIN_ID"])),
        stdin=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )


def _end(process: subprocess.Popen[str]) -> None:
    if process.poll() is None:
        process.kill()
        process.wait()


def _held(storage: str, seconds: float, rate: float) -> float | None:
    """The rate at which the sender really sent, if the bag holds every message of it."""
    from course_kit.lab.bags import files as bag_files

    os.environ["ROS_DOMAIN_ID"] = str(reserve_domain())
    with tempfile.TemporaryDirectory() as folder:
        bag = Path(folder, "bag")
        count = int(rate * seconds)
        with Sender("/recorded", "scan", rate=rate, count=count, depth=DEPTH) as sender:
            recorder = _ros2("record", "-o", str(bag), "-s", storage, "--topics", "/recorded")
            try:
                assert recorder.stderr is not None
                for line in recorder.stderr:
                    if "Subscribed to topic" in line:
                        break
                sender.go()
                result = sender.result()
                time.sleep(QUIET)
                recorder.send_signal(signal.SIGINT)
                recorder.communicate(timeout=60)
            finally:
                _end(recorder)
        written = bag_files.info(bag).message_count
    return float(result["rate"]) if written == result["sent"] and result["rate"] >= KEPT * rate else None


def _played(seconds: float) -> list[float]:
    """How far from its time each message of a bag came, in ms, sorted."""
    os.environ["ROS_DOMAIN_ID"] = str(reserve_domain())
    from rclpy.serialization import serialize_message
    from std_msgs.msg import String

    from course_kit.base.polling import wait_until
    from course_kit.lab.bags.writer import BagWriter
    from course_kit.ros.spinning import context
    from course_kit.ros.subscriptions import observer_node

    count = int(seconds * PLAY_RATE)
    times: list[int] = []
    with tempfile.TemporaryDirectory() as folder:
        writer = BagWriter(Path(folder, "bag"))
        writer.add_topic("/played", "std_msgs/msg/String")
        for number in range(count):
            writer.write("/played", 10**18 + number * 10**9 // PLAY_RATE, serialize_message(String(data=str(number))))
        writer.close()
        subscription = observer_node.subscribe(
            "/played", lambda data, info: times.append(info["received_timestamp"]), String
        )
        player = _ros2("play", str(writer.folder))
        try:
            player.communicate(timeout=seconds + 60)
            wait_until(lambda: len(times) == count, 5)
        finally:
            _end(player)
            subscription.close()
    context.stop()
    if len(times) != count:
        raise RuntimeError(f"{len(times)} of {count} messages of the bag came")
    differences = [time_ns * 1e-6 - number * 1000 / PLAY_RATE for number, time_ns in enumerate(times)]
    start = statistics.median(differences)
    return sorted(abs(difference - start) for difference in differences)
