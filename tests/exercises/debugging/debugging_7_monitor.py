"""Answers to debugging-7: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

MONITOR = worked("debugging-7")

SLIDING = """
from collections import deque
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.lifecycle import LifecycleNode
from rclpy.qos import QoSProfile, ReliabilityPolicy

class Monitor(LifecycleNode):
    def __init__(self):
        super().__init__("monitor")
        qos = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)
        self.watched = {"/scan": (10.0, deque()), "/turtle1/pose": (62.5, deque())}
        self.out = self.create_publisher(DiagnosticArray, "/diagnostics", 10)
        for (topic, (_, times)), kind in zip(self.watched.items(), (LaserScan, Pose)):
            self.create_subscription(kind, topic, lambda _, times=times: times.append(time.monotonic()), qos)
        self.create_timer(1.0, self.report)

    def status(self, topic):
        wanted, times = self.watched[topic]
        while times and time.monotonic() - times[0] > 1.0:
            times.popleft()
        share = len(times) / wanted
        status = DiagnosticStatus(name=topic, hardware_id="turtle1", message=f"{100 * share:.0f} %")
        status.level = b"\\x03" if not times else b"\\x00" if share >= 0.8 else b"\\x01"
        status.values = [KeyValue(key="wanted", value=str(wanted)), KeyValue(key="rate", value=f"{len(times):.1f}Hz")]
        return status

    def report(self):
        own = DiagnosticStatus(name="/monitor", level=DiagnosticStatus.OK)
        self.out.publish(DiagnosticArray(status=[own, *map(self.status, self.watched)]))
"""

ELAPSED = """
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

class WatchedTopic:
    def __init__(self, node, topic, kind, rate):
        self.topic, self.rate, self.count, self.since = topic, rate, 0, time.perf_counter()
        node.create_subscription(kind, topic, self.on_message, qos_profile_sensor_data)

    def on_message(self, message):
        self.count += 1

    def take(self):
        now = time.perf_counter()
        measured, self.count, self.since = self.count / (now - self.since), 0, now
        return measured

class Monitor(Node):
    def __init__(self):
        Node.__init__(self, "monitor")
        self.watched = [WatchedTopic(self, "scan", LaserScan, 10.0), WatchedTopic(self, "turtle1/pose", Pose, 62.5)]
        self.out = self.create_publisher(DiagnosticArray, "diagnostics", 1)
        self.create_timer(1.0, self.report)

    def report(self):
        array = DiagnosticArray()
        for one in self.watched:
            rate, status = one.take(), DiagnosticStatus(name="/" + one.topic)
            if rate == 0:
                status.level = DiagnosticStatus.STALE
            elif rate < 0.8 * one.rate:
                status.level = DiagnosticStatus.WARN
            status.values.append(KeyValue(key="rate", value=f"{rate:.2f} Hz"))
            array.status.insert(0, status)
        self.out.publish(array)
"""


THREADED = f"""
from rclpy.executors import MultiThreadedExecutor
{ELAPSED}
monitor = run(Monitor, executor=MultiThreadedExecutor())
"""

ANSWERS = Answers(
    "debugging-7",
    5,
    MONITOR,
    [
        Wrong("no_stale", changed(MONITOR, ("STALE if came == 0 else DiagnosticStatus.WARN", "WARN")), 4, "STALE"),
        Wrong(
            "grows",
            changed(MONITOR, ("came, self.counts[topic] = self.counts[topic], 0", "came = self.counts[topic]")),
            3,
            "begin to count anew",
        ),
        Wrong("names", changed(MONITOR, ("name=topic", "name=topic[1:]")), 1, "with the topic as its name"),
        Wrong("no_rate", changed(MONITOR, (", values=[value]", "")), 4, "KeyValue"),
        Wrong("half", changed(MONITOR, ("0.8 * rate", "0.5 * rate")), 4, "Below 80 %"),
        Wrong("all", changed(MONITOR, ("0.8 * rate", "0.95 * rate")), 4, "is at least 80 %"),
        Wrong(
            "no_more",
            changed(MONITOR, ("if came >= 0.8 * rate", "if 0.8 * rate <= came <= 1.2 * rate")),
            4,
            "it said WARN. What comes is at least 80 %",
        ),
        Wrong(
            "all_scans",
            changed(MONITOR, ("0.8 * rate", '(1.0 if topic == "/scan" else 0.8) * rate')),
            4,
            "a second came on /scan it said WARN",
        ),
        Wrong(
            "no_more_poses",
            changed(MONITOR, ("if came >= 0.8 * rate", "if 75 >= came >= 0.8 * rate")),
            4,
            "a second came on /turtle1/pose it said WARN",
        ),
        Wrong("wanted_rate", changed(MONITOR, ("value=str(float(came))", "value=str(rate)")), 4, "of the last second"),
        Wrong(
            "last_rate",
            changed(
                MONITOR,
                (
                    "            value = Key",
                    "            self.rates[topic] = came or self.rates.get(topic, 0)\n            value = Key",
                ),
                ("str(float(came))", "str(self.rates[topic])"),
                ("(Node):\n", "(Node):\n    rates = {}\n"),
            ),
            4,
            "0.0 of",
        ),
        Wrong(
            "worst_of_both",
            changed(
                MONITOR,
                (
                    "        self.publisher.publish(report)",
                    "        for one in report.status: one.level = max(s.level for s in report.status)\n"
                    "        self.publisher.publish(report)",
                ),
            ),
            3,
            "each topic by itself",
        ),
        Wrong(
            "an_array_each",
            changed(
                MONITOR,
                (
                    "        self.publisher.publish(report)",
                    "        for one in report.status: self.publisher.publish(DiagnosticArray(status=[one]))",
                ),
            ),
            3,
            "in one array",
        ),
    ],
    {"sliding": SLIDING, "elapsed": ELAPSED, "threads": THREADED},
    together=8,
)
