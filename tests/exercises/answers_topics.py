"""Answers to chapter 3's exercises: one that is right, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong

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

FIGURE_EIGHT = """
class FigureEight(Node):
    def __init__(self):
        super().__init__("figure_eight")
        self.publisher = self.create_publisher(Twist, "turtle1/cmd_vel", 10)
        self.create_subscription(Pose, "turtle1/pose", self.on_pose, 10)
        self.turned, self.last, self.sign = 0.0, None, 1

    def on_pose(self, pose):
        twist = Twist()
        if self.last is not None:
            self.turned += math.remainder(pose.theta - self.last, math.tau)
        self.last = pose.theta
        if self.sign > 0 and self.turned >= math.tau - 0.03:
            self.sign = -1
        elif self.sign < 0 and self.turned <= 0.03:
            self.sign = 0
        if self.sign:
            twist.linear.x, twist.angular.z = 3.0, self.sign * 2.0
        self.publisher.publish(twist)
"""


def changed(source: str, *changes: tuple[str, str]) -> str:
    """The source with parts of it replaced; each part must be there."""
    for old, new in changes:
        assert old in source, old
        source = source.replace(old, new)
    return source


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
            Wrong("at_once", changed(COUNTDOWN, ("== 0", "< 0")), 1, "a message that is sent before a subscription"),
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
        ],
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
            Wrong("counts_ranges", changed(SCAN_COUNTER, ("+= 1", "+= len(scan.ranges)")), 1, "is 60 after 20 scans"),
            Wrong("no_count", changed(SCAN_COUNTER, ("self.count", "self.number")), 1, "no readable `self.count`"),
        ],
    ),
    Answers(
        "topics-3",
        3,
        RELAY,
        [
            Wrong(
                "all", changed(RELAY, ("if self.count % 10 == 0:", "if True:")), 1, "count the calls of the callback"
            ),
            Wrong("every_fifth", changed(RELAY, ("% 10", "% 5")), 1, "32 came, most of them 5 after"),
            Wrong(
                "empty",
                changed(RELAY, ("publish(pose)", "publish(Pose())")),
                1,
                "Publish the message that the callback",
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
    ),
    Answers(
        "topics-4",
        5,
        FIGURE_EIGHT,
        [
            Wrong(
                "both_left",
                changed(
                    FIGURE_EIGHT,
                    ("self.sign * 2.0", "2.0"),
                    ("self.turned <= 0.03", "self.turned >= 2 * math.tau - 0.03"),
                ),
                2,
                "the opposite sign of angular.z",
            ),
            Wrong(
                "sizes", changed(FIGURE_EIGHT, ("= 3.0,", "= 3.0 if self.sign > 0 else 2.0,")), 4, "Their lengths are"
            ),
            Wrong("for_ever", changed(FIGURE_EIGHT, ("self.sign = 0", "self.sign = 1")), 0, "It still moves after"),
            Wrong(
                "one_circle",
                changed(FIGURE_EIGHT, ("self.sign = -1", "self.sign = 0")),
                3,
                "After the first it turned by 0°",
            ),
            Wrong(
                "not_closed",
                changed(FIGURE_EIGHT, ("self.turned <= 0.03", "self.turned <= 0.6")),
                3,
                "m from where it began",
            ),
        ],
    ),
]
