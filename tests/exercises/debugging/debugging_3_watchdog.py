"""Answers to debugging-3: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

WATCHDOG = "\nstop()" + worked("debugging-3")

# The watchdog in further styles.
STAMPS = """
stop()
from collections import deque
from rclpy.duration import Duration
from rclpy.lifecycle import LifecycleNode
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import Bool

class Watchdog(LifecycleNode):
    def __init__(self):
        super().__init__("watchdog")
        self.stamps = deque(maxlen=1)
        qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
        self.alive = self.create_publisher(Bool, "/scan_alive", 1)
        self.create_subscription(LaserScan, "/scan", lambda scan: self.stamps.append(self.get_clock().now()), qos)
        self.create_timer(0.2, self.tick)
        self.get_logger().info("watching")

    def tick(self):
        now, limit = self.get_clock().now(), Duration(seconds=0.5)
        self.alive.publish(Bool(data=any(now - stamp <= limit for stamp in self.stamps)))
"""

ONE_SHOT = """
stop()
from std_msgs.msg import Bool

class Watchdog(Node):
    def __init__(self):
        Node.__init__(self, "watchdog")
        self.alive, self.is_alive = self.create_publisher(Bool, "scan_alive", 10), False
        self.limit = self.create_timer(0.5, self.give_up, autostart=False)
        self.create_subscription(LaserScan, "scan", self.on_scan, qos_profile_sensor_data)
        self.create_timer(1 / 5, self.tick)

    def on_scan(self, scan):
        self.is_alive = True
        self.limit.reset()

    def give_up(self):
        self.is_alive = False
        self.limit.cancel()

    def tick(self):
        message = Bool()
        message.data = self.is_alive
        self.alive.publish(message)
"""

THREADS = """
stop()
import threading
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from std_msgs.msg import Bool, String

class Watchdog(Node):
    def __init__(self):
        super().__init__("watchdog")
        group, self.lock, self.came = ReentrantCallbackGroup(), threading.Lock(), None
        self.pub, self.extra = self.create_publisher(Bool, "scan_alive", 10), self.create_publisher(String, "words", 10)
        self.create_subscription(LaserScan, "scan", self.on_scan, qos_profile_sensor_data, callback_group=group)
        self.create_timer(0.2, self.tick, callback_group=group)

    async def on_scan(self, scan):
        with self.lock:
            self.came = time.perf_counter()

    async def tick(self):
        with self.lock:
            is_alive = self.came is not None and time.perf_counter() - self.came <= 0.5
        self.pub.publish(Bool(data=is_alive))
        self.extra.publish(String(data="alive" if is_alive else "silent"))

watchdog = run(Watchdog, executor=MultiThreadedExecutor())
"""

FLAG = """
stop()
from std_msgs.msg import Bool

class Watchdog(Node):
    def __init__(self):
        super().__init__("watchdog")
        self.came = False
        self.publisher = self.create_publisher(Bool, "scan_alive", 10)
        self.create_subscription(LaserScan, "scan", self.on_scan, qos_profile_sensor_data)
        self.create_timer(0.2, self.tick)

    def on_scan(self, scan):
        self.came = True

    def tick(self):
        self.publisher.publish(Bool(data=self.came))
        self.came = False
"""

ANSWERS = Answers(
    "debugging-3",
    3,
    WATCHDOG,
    [
        Wrong("qos", changed(WATCHDOG, ("on_scan, qos_profile_sensor_data", "on_scan, 10")), 1, "RELIABLE"),
        Wrong("for_ever", changed(WATCHDOG, ("- self.came < 0.5", "- self.came < 1e6")), 2, "s after the last scan"),
        Wrong("true_first", changed(WATCHDOG, ("-1e9", "time.monotonic() + 2.0")), 2, "Nothing had come yet"),
        Wrong("rate", changed(WATCHDOG, ("0.2, self.tick", "0.1, self.tick")), 2, "ros2 topic hz /scan_alive"),
        Wrong("flag", FLAG, 2, "It said false 0."),
        Wrong("one_second", changed(WATCHDOG, ("- self.came < 0.5", "- self.came < 1.0")), 2, "s after the last scan"),
        Wrong("limit", changed(WATCHDOG, ("- self.came < 0.5", "- self.came < 0.3")), 2, "s after a scan: keep"),
        Wrong("four", changed(WATCHDOG, ("0.2, self.tick", "0.25, self.tick")), 2, "one timer with a period of 0.2 s"),
        Wrong("six", changed(WATCHDOG, ("0.2, self.tick", "1 / 6, self.tick")), 2, "one timer with a period of 0.2 s"),
        Wrong(  # five a second in all, as a busy machine makes of six
            "six_with_a_rest",
            changed(
                WATCHDOG,
                ("-1e9\n", "-1e9\n        self.ticks = 0\n"),
                ("0.2, self.tick", "1 / 6, self.tick"),
                (
                    "        self.publisher.publish",
                    "        self.ticks += 1\n        if self.ticks % 6:\n            self.publisher.publish",
                ),
            ),
            2,
            "mostly 0.17 s apart",
        ),
        Wrong("too_short", changed(WATCHDOG, ("- self.came < 0.5", "- self.came < 0.25")), 2, "s after a scan: keep"),
        Wrong(
            "in_the_callback",
            changed(
                WATCHDOG,
                (
                    "        self.came = time.monotonic()\n",
                    "        self.came = time.monotonic()\n        self.tick()\n",
                ),
            ),
            2,
            "a period of 0.2 s publishes, and nothing else",
        ),
        Wrong(
            "beams",
            changed(WATCHDOG, ("        self.came = time.m", "        if len(scan.ranges) > 1: self.came = time.m")),
            2,
            "It said false 0.",
        ),
        Wrong(
            "counts",
            changed(
                WATCHDOG,
                ("self.came = -1e9", "self.came = 0"),
                ("self.came = time.monotonic()", "self.came += 1"),
                ("time.monotonic() - self.came < 0.5", "0 < self.came < 20"),
            ),
            2,
            "keep the time of each scan",
        ),
    ],
    {"stamps": STAMPS, "one_shot": ONE_SHOT, "threads": THREADS},
)
