"""Answers to topics-2: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked
from tests.exercises.topics import styles

SCAN_COUNTER = worked("topics-2")

ANSWERS = Answers(
    "topics-2",
    2,
    SCAN_COUNTER,
    [
        Wrong(
            "reliable",
            changed(SCAN_COUNTER, ("self.on_scan, qos_profile_sensor_data", "self.on_scan, 10")),
            0,
            "It asks for RELIABLE",
        ),
        Wrong(
            "latched",
            changed(
                SCAN_COUNTER,
                (
                    "self.on_scan, qos_profile_sensor_data",
                    "self.on_scan, QoSProfile("
                    "depth=5, reliability=ReliabilityPolicy.BEST_EFFORT, "
                    "durability=DurabilityPolicy.TRANSIENT_LOCAL)",
                ),
                ("import qos_profile_sensor_data", "import DurabilityPolicy, QoSProfile, ReliabilityPolicy"),
            ),
            0,
            "It asks for TRANSIENT_LOCAL",
        ),
        Wrong("topic", changed(SCAN_COUNTER, ('"scan"', '"laser_scan"')), 0, "Your node subscribes to /laser_scan"),
        Wrong("counts_ranges", changed(SCAN_COUNTER, ("+= 1", "+= len(scan.ranges)")), 1, "whatever is in it"),
        Wrong("no_count", changed(SCAN_COUNTER, ("self.count", "self.number")), 1, "no readable `self.count`"),
        Wrong("constant", changed(SCAN_COUNTER, ("count = 0", "count = 20"), ("+= 1", "+= 0")), 1, "is 20 after"),
        Wrong("begins_with_1", changed(SCAN_COUNTER, ("count = 0", "count = 1")), 1, "begin with 0"),
        Wrong("begins_with_the_second", changed(SCAN_COUNTER, ("count = 0", "count = -1")), 1, "begin with 0"),
        Wrong(
            "class_counts",
            changed(SCAN_COUNTER, ("self.count = 0", "pass"), ("self.count +", "type(self).count +"))
            + "\n    count = 3\n",
            1,
            "begin with 0",
        ),
        Wrong(
            "not_empty_ones",
            changed(SCAN_COUNTER, ("self.count += 1", "self.count += bool(scan.ranges)")),
            1,
            "add 1",
        ),
        Wrong(
            "only_what_is_near",
            changed(SCAN_COUNTER, ("self.count += 1", "self.count += any(r < 100 for r in scan.ranges)")),
            1,
            "for each message",
        ),
        Wrong(
            "anew_every_3_seconds",
            changed(
                SCAN_COUNTER,
                ("self.count = 0", "self.count = 0\n        self.create_timer(3.0, self.begin)"),
                ("    def on_scan", "    def begin(self):\n        self.count = 0\n\n    def on_scan"),
            ),
            1,
            "never begin anew",
        ),
        Wrong(
            "not_the_same_ranges",
            changed(
                SCAN_COUNTER,
                ("self.count = 0", "self.count, self.last = 0, None"),
                (
                    "        self.count += 1",
                    "        self.count += self.last != scan.ranges\n        self.last = scan.ranges",
                ),
            ),
            1,
            "whatever is in it",
        ),
        Wrong("every_other", changed(SCAN_COUNTER, ("+= 1", "+= 0.5")), 1, "for each message"),
        Wrong(
            "anew_after_a_pause",
            changed(
                SCAN_COUNTER,
                (
                    "        self.count += 1",
                    "        now = self.get_clock().now().nanoseconds\n"
                    "        self.count = self.count + 1 if now - getattr(self, 'last', now) < 2e8 else 1\n"
                    "        self.last = now",
                ),
            ),
            1,
            "for each message",
        ),
    ],
    styles.SCAN_COUNTER,
)
