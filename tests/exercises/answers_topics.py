"""Answers to chapter 3's exercises: one that is right, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises import answers_topics_eight as eight
from tests.exercises import answers_topics_styles as styles
from tests.exercises.chapter import Answers, Wrong, changed

CELLS = ()  # of the chapter that are run: what they import is below
PREPARE = """
import math

from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose

from course_kit import run
"""

COUNTDOWN = """
from std_msgs.msg import Int32

class Countdown(Node):
    def __init__(self):
        super().__init__("countdown")
        self.publisher = self.create_publisher(Int32, "countdown", 10)
        self.timer = self.create_timer(0.2, self.tick)
        self.left = 10

    def tick(self):
        if self.publisher.get_subscription_count() == 0:
            return
        self.publisher.publish(Int32(data=self.left))
        self.left -= 1
        if self.left < 0:
            self.timer.cancel()

countdown = run(Countdown)
"""

SCAN_COUNTER = """
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan

class ScanCounter(Node):
    def __init__(self):
        super().__init__("scan_counter")
        self.count = 0
        self.create_subscription(LaserScan, "scan", self.on_scan, qos_profile_sensor_data)

    def on_scan(self, scan):
        self.count += 1
"""

RELAY = """
class Relay(Node):
    def __init__(self):
        super().__init__("relay")
        self.publisher = self.create_publisher(Pose, "turtle1/pose_slow", 10)
        self.create_subscription(Pose, "turtle1/pose", self.on_pose, 10)
        self.count = 0

    def on_pose(self, pose):
        self.count += 1
        if self.count % 10 == 0:
            self.publisher.publish(pose)
"""

BURSTS = """
from std_msgs.msg import Int32

class Countdown(Node):
    def __init__(self):
        super().__init__("countdown")
        self.publisher = self.create_publisher(Int32, "countdown", 20)
        self.timer = self.create_timer(1.0, self.tick)
        self.left = 10

    def tick(self):
        if self.publisher.get_subscription_count():
            for _ in range(5):
                if self.left >= 0:
                    self.publisher.publish(Int32(data=self.left))
                    self.left -= 1
"""

FOR_EACH_LISTENER = """
from rclpy.event_handler import PublisherEventCallbacks
from std_msgs.msg import Int32

class Countdown(Node):
    def __init__(self):
        super().__init__("countdown")
        self.left, self.timer = -1, None
        self.publisher = self.create_publisher(
            Int32, "countdown", 10, event_callbacks=PublisherEventCallbacks(matched=self.on_matched))

    def on_matched(self, status):
        if status.current_count_change > 0 and self.left < 0:
            self.left = 10
            self.timer = self.create_timer(0.2, self.tick)

    def tick(self):
        self.publisher.publish(Int32(data=self.left))
        self.left -= 1
        if self.left < 0:
            self.timer.cancel()
"""

EVERY_160_MS = """
class Relay(Node):
    def __init__(self):
        super().__init__("relay")
        self.publisher = self.create_publisher(Pose, "turtle1/pose_slow", 10)
        self.last = None
        self.create_subscription(Pose, "turtle1/pose", self.on_pose, 10)
        self.create_timer(0.16, self.tick)

    def on_pose(self, pose):
        self.last = pose

    def tick(self):
        if self.last is not None:
            self.publisher.publish(self.last)
            self.last = None
"""

NOT_AT_ONCE = """
class Relay(Node):
    def __init__(self):
        super().__init__("relay")
        self.publisher = self.create_publisher(Pose, "turtle1/pose_slow", 10)
        self.create_subscription(Pose, "turtle1/pose", self.on_pose, 10)
        self.create_timer(0.3, self.tick)
        self.count, self.kept = 0, []

    def on_pose(self, pose):
        self.count += 1
        if self.count % 10 == 0:
            self.kept.append(pose)

    def tick(self):
        while self.kept:
            self.publisher.publish(self.kept.pop(0))
"""

# Of COUNTDOWN: numbers by the time that has passed since it was made, so all at once for a late listener.
CATCHES_UP = changed(
    COUNTDOWN,
    ("timer(0.2,", "timer(0.02,"),
    ("self.left = 10", "self.left, self.ticks = 10, 0"),
    ("    def tick(self):\n", "    def tick(self):\n        self.ticks += 1\n"),
    ("count() == 0:", "count() == 0 or self.ticks < 10 * (10 - self.left):"),
)

LISTENS = "self.publisher.get_subscription_count() == 0"  # of COUNTDOWN: none does
CALLBACK = "self.count += 1\n"  # of SCAN_COUNTER

ANSWERS = [
    Answers(
        "topics-1",
        2,
        COUNTDOWN,
        [
            Wrong(
                "type",
                changed(COUNTDOWN, ("Int32", "String"), ("data=self.left", "data=str(self.left)")),
                0,
                "Its type is std_msgs/msg/String",
            ),
            Wrong("at_once", changed(COUNTDOWN, ("== 0", "< 0")), 1, "before a subscription has matched is lost"),
            Wrong("goes_on", changed(COUNTDOWN, ("self.timer.cancel()", "pass")), 1, "It goes on after 0"),
            Wrong("slow", changed(COUNTDOWN, ("0.2, self", "0.4, self")), 1, "It was 2.5 Hz"),
            Wrong(
                "topic", changed(COUNTDOWN, ('"countdown", 10', '"count_down", 10')), 0, "Did you mean `/count_down`?"
            ),
            Wrong(
                "node_of_another",
                changed(COUNTDOWN, ('__init__("countdown")', '__init__("talker")')),
                0,
                "Your node is called /talker",
            ),
            Wrong(
                "up",
                changed(COUNTDOWN, ("left = 10", "left = 0"), ("left -= 1", "left += 1"), ("left < 0", "left > 10")),
                1,
                "It counts up",
            ),
            Wrong("no_node", "class Countdown:\n    pass\n", 0, "Write: class Countdown(Node)"),
            Wrong("raises", changed(COUNTDOWN, ("self.left = 10", "self.left = ten")), 0, "name 'ten' is not defined"),
            Wrong(
                "callback_raises",
                changed(COUNTDOWN, ("data=self.left", "data=str(self.left)")),
                0,
                "The 'data' field must be of type 'int'",
            ),
            *(
                # That many ticks, 0.2 s each, in place of a listener.
                Wrong(
                    f"waits_{ticks}_ticks",
                    changed(
                        COUNTDOWN,
                        (f"if {LISTENS}:", f"self.ticks += 1\n        if self.ticks < {ticks}:"),
                        ("self.left = 10", "self.left, self.ticks = 10, 0"),
                    ),
                    1,
                    "get_subscription_count()",
                )
                for ticks in (4, 9, 15, 18)
            ),
            Wrong(
                "of_the_class",
                changed(
                    COUNTDOWN,
                    ("    def __init__", "    left = 10\n\n    def __init__"),
                    ("self.left = 10", "pass"),
                    ("self.left", "Countdown.left"),
                ),
                1,
                "each new node",
            ),
            Wrong(
                "ten_to_nobody",
                changed(
                    COUNTDOWN, (f"if {LISTENS}:", f"if {LISTENS}:\n            self.publisher.publish(Int32(data=10))")
                ),
                1,
                "before somebody listens",
            ),
            Wrong("five_at_once", BURSTS, 1, "unevenly"),
            Wrong("for_each_listener", FOR_EACH_LISTENER, 1, "counts again for who comes later"),
            Wrong(
                "back_to_10", changed(FOR_EACH_LISTENER, (" and self.left < 0", "")), 1, "counts again for who comes"
            ),
            Wrong(
                "again_after_a_second",
                changed(
                    COUNTDOWN,
                    ("self.left < 0", "self.left < -5"),
                    ("self.timer.cancel()", "self.left = 10"),
                    ("        self.publisher.p", "        if self.left >= 0:\n            self.publisher.p"),
                ),
                1,
                "It goes on after 0",
            ),
            Wrong(
                "zero_again_later",
                changed(
                    COUNTDOWN,
                    ("self.left < 0", "self.left < -8"),
                    (
                        "        self.publisher.publish(Int32(data=self.left))",
                        "        if self.left >= 0 or self.left == -6:\n"
                        "            self.publisher.publish(Int32(data=max(0, self.left)))",
                    ),
                ),
                1,
                "It goes on after 0",
            ),
            Wrong("catches_up", CATCHES_UP, 1, "in one of two counts"),
            Wrong(
                "each_node_slower",
                changed(
                    COUNTDOWN,
                    ("    def __init__", "    period = 0.05\n\n    def __init__"),
                    ("timer(0.2,", "timer(self.period,"),
                    ("self.left = 10", "self.left = 10\n        Countdown.period += 0.15"),
                ),
                1,
                "in one of two counts",
            ),
            Wrong("without_0", changed(COUNTDOWN, ("left < 0", "left < 1")), 1, "each once"),
        ],
        styles.COUNTDOWN,
    ),
    Answers(
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
    ),
    Answers(
        "topics-3",
        3,
        RELAY,
        [
            Wrong(
                "all", changed(RELAY, ("if self.count % 10 == 0:", "if True:")), 1, "count the calls of the callback"
            ),
            Wrong("every_fifth", changed(RELAY, ("% 10", "% 5")), 1, "most of them 5 after"),
            Wrong("every_eleventh", changed(RELAY, ("% 10", "% 11")), 2, "most of them 11 after"),
            Wrong(
                "empty",
                changed(RELAY, ("publish(pose)", "publish(Pose())")),
                1,
                "Publish the message that the callback",
            ),
            Wrong(
                "without_velocities",
                changed(RELAY, ("publish(pose)", "publish(Pose(x=pose.x, y=pose.y, theta=pose.theta))")),
                2,
                "of a pose came out otherwise",
            ),
            Wrong(
                "rounded",
                changed(
                    RELAY,
                    (
                        "publish(pose)",
                        "publish(Pose(x=round(pose.x, 2), y=pose.y, theta=pose.theta, "
                        "linear_velocity=pose.linear_velocity, angular_velocity=pose.angular_velocity))",
                    ),
                ),
                2,
                "x of a pose came out otherwise",
            ),
            Wrong("every_160_ms", EVERY_160_MS, 1, "not the time"),
            Wrong(
                "no_sooner_than_160_ms",
                changed(
                    RELAY,
                    ("self.count = 0", "self.last = 0"),
                    ("self.count += 1", "now = self.get_clock().now().nanoseconds"),
                    ("if self.count % 10 == 0:", "if now - self.last > 152e6:\n            self.last = now"),
                ),
                1,
                "not the time",
            ),
            Wrong(
                "not_equal_ones",
                changed(
                    RELAY,
                    ("self.count = 0", "self.count, self.last = 0, None"),
                    (
                        "        self.count += 1",
                        "        if pose == self.last:\n            return\n        self.last = pose\n"
                        "        self.count += 1",
                    ),
                ),
                2,
                "equal poses",
            ),
            Wrong(
                "the_one_before",
                changed(
                    RELAY,
                    ("publish(pose)", "publish(self.last)\n        self.last = pose"),
                ),
                2,
                "before the next comes",
            ),
            Wrong(
                "begins_with_the_11th",
                changed(RELAY, ("count = 0", "count = 9"), ("% 10 == 0", "% 10 == 0 and self.count > 10")),
                2,
                "number 11",
            ),
            Wrong(
                "begins_with_the_20th", changed(RELAY, ("% 10 == 0", "% 10 == 0 and self.count > 10")), 2, "number 20"
            ),
            Wrong(
                "one_of_six_later",
                changed(RELAY, ("self.count += 1", "self.count = self.count % 61 + 1")),
                2,
                "not 10 after it",
            ),
            Wrong("not_at_once", NOT_AT_ONCE, 2, "publish the tenth pose in its own callback"),
            Wrong(
                "only_while_it_moves",
                changed(
                    RELAY,
                    ("self.count += 1", "if not pose.linear_velocity:\n            return\n        self.count += 1"),
                ),
                1,
                "count the calls of the callback",
            ),
            Wrong(
                "twice",
                changed(RELAY, ("publish(pose)", "publish(pose)\n            self.publisher.publish(pose)")),
                1,
                "0 after",
            ),
            Wrong(
                "type",
                changed(
                    RELAY,
                    ('(Pose, "turtle1/pose_slow"', '(Twist, "turtle1/pose_slow"'),
                    ("publish(pose)", "publish(Twist())"),
                ),
                0,
                "Its type is geometry_msgs/msg/Twist",
            ),
            Wrong("wrong_topic", changed(RELAY, ("turtle1/pose_slow", "pose_slow")), 0, "Did you mean `/pose_slow`?"),
        ],
        styles.RELAY,
    ),
    eight.ANSWERS,
]
