"""Answers to chapter 6's exercises: one that is right, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.answers_topics import changed
from tests.exercises.chapter import Answers, Wrong

CELLS = ()  # of the chapter that are run: what they import is below, and their nodes are not needed
PREPARE = """
import math
import time

from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from turtlesim.msg import Pose

from course_kit import bags, faults, run, start, stop, wait_for
from course_kit.turtlesim import TurtleSim
"""

KEEPS = """
stop()
kept, lossy = "/speed_limit", "/scan"
"""

QUIET = """
stop()

class Quiet(Node):
    def __init__(self):
        super().__init__("quiet", enable_logger_service=True)
        self.create_subscription(Pose, "turtle1/pose", self.on_pose, 10)

    def on_pose(self, pose):
        text = f"x = {pose.x:.2f}"
        self.get_logger().info(text, throttle_duration_sec=1.0)
        self.get_logger().debug(text)

turtlesim, quiet = run(TurtleSim), run(Quiet)
"""

WATCHDOG = """
stop()
from std_msgs.msg import Bool

class Watchdog(Node):
    def __init__(self):
        super().__init__("watchdog")
        self.came = -1e9
        self.publisher = self.create_publisher(Bool, "scan_alive", 10)
        self.create_subscription(LaserScan, "scan", self.on_scan, qos_profile_sensor_data)
        self.create_timer(0.2, self.tick)

    def on_scan(self, scan):
        self.came = time.monotonic()

    def tick(self):
        self.publisher.publish(Bool(data=time.monotonic() - self.came < 0.5))
"""

CIRCLE = """
stop()

class Circle(Node):
    def __init__(self):
        super().__init__("circle")
        self.publisher = self.create_publisher(Twist, "turtle1/cmd_vel", 10)
        self.create_timer(0.1, self.tick)

    def tick(self):
        twist = Twist()
        twist.linear.x, twist.angular.z = 2.0, 1.2
        self.publisher.publish(twist)

run(TurtleSim)
run(Circle)
with bags.record("circle", "/turtle1/pose", "/turtle1/cmd_vel", overwrite=True) as bag:
    wait_for(lambda: bag.message_count > 440, timeout=30)
stop()
circle = "circle"
"""

MILEAGE = """
from std_msgs.msg import Float32

class Mileage(Node):
    def __init__(self):
        super().__init__("mileage")
        self.before, self.way = None, 0.0
        self.publisher = self.create_publisher(Float32, "mileage", 10)
        self.create_subscription(Pose, "turtle1/pose", self.on_pose, 50)

    def on_pose(self, pose):
        here = (pose.x, pose.y)
        step = math.dist(here, self.before) if self.before else 0.0
        if step <= 0.2:
            self.way += step
        self.before = here
        self.publisher.publish(Float32(data=self.way))
"""

MONITOR = """
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

class Monitor(Node):
    wanted = {"/scan": 10.0, "/turtle1/pose": 62.5}

    def __init__(self):
        super().__init__("monitor")
        self.counts = dict.fromkeys(self.wanted, 0)
        self.publisher = self.create_publisher(DiagnosticArray, "diagnostics", 10)
        self.create_subscription(LaserScan, "scan", lambda scan: self.count("/scan"), qos_profile_sensor_data)
        self.create_subscription(Pose, "turtle1/pose", lambda pose: self.count("/turtle1/pose"), 50)
        self.create_timer(1.0, self.report)

    def count(self, topic):
        self.counts[topic] += 1

    def report(self):
        report = DiagnosticArray()
        report.header.stamp = self.get_clock().now().to_msg()
        for topic, rate in self.wanted.items():
            came, self.counts[topic] = self.counts[topic], 0
            level = DiagnosticStatus.STALE if came == 0 else DiagnosticStatus.WARN
            level = DiagnosticStatus.OK if came >= 0.8 * rate else level
            value = KeyValue(key="rate", value=str(float(came)))
            report.status.append(DiagnosticStatus(name=topic, level=level, values=[value]))
        self.publisher.publish(report)
"""

PATIENTS = """
stop()
faults.start(seed=17)
start("ros2 run patrol map_server", name="map_server")
seed_9, seed_31, seed_17 = "not_sourced", "clock", "queue"
"""

ANSWERS = [
    Answers(
        "debugging-1",
        2,
        KEEPS,
        [
            Wrong("swapped", changed(KEEPS, ('"/speed_limit", "/scan"', '"/scan", "/speed_limit"')), 0, "Durability"),
            Wrong("half", changed(KEEPS, ('"/scan"', '"/map_scans"')), 1, "Reliability BEST_EFFORT"),
            Wrong("node", changed(KEEPS, ('"/speed_limit"', '"/map_server"')), 1, "Durability TRANSIENT_LOCAL"),
        ],
    ),
    Answers(
        "debugging-2",
        3,
        QUIET,
        [
            Wrong("loud", changed(QUIET, (", throttle_duration_sec=1.0", "")), 2, "throttle_duration_sec=1.0"),
            Wrong("no_service", changed(QUIET, (", enable_logger_service=True", "")), 1, "enable_logger_service=True"),
            Wrong("no_debug", changed(QUIET, ("        self.get_logger().debug(text)\n", "")), 2, "`debug(…)` for"),
            Wrong("no_turtle", changed(QUIET, ("turtlesim, quiet = run(TurtleSim), run", "quiet = run")), 0, "run(Tur"),
        ],
    ),
    Answers(
        "debugging-3",
        3,
        WATCHDOG,
        [
            Wrong("qos", changed(WATCHDOG, ("on_scan, qos_profile_sensor_data", "on_scan, 10")), 1, "RELIABLE"),
            Wrong("for_ever", changed(WATCHDOG, ("- self.came < 0.5", "- self.came < 1e6")), 2, "not within 2 s"),
            Wrong("true_first", changed(WATCHDOG, ("-1e9", "time.monotonic() + 2.0")), 2, "Nothing had come yet"),
            Wrong("rate", changed(WATCHDOG, ("0.2, self.tick", "0.1, self.tick")), 2, "ros2 topic hz /scan_alive"),
        ],
    ),
    Answers(
        "debugging-4",
        2,
        CIRCLE,
        [
            Wrong("topics", changed(CIRCLE, (', "/turtle1/cmd_vel", over', ", over")), 1, "name the topics"),
            Wrong("slow", changed(CIRCLE, ("2.0, 1.2", "0.5, 0.4")), 1, "a circle takes"),
            Wrong("no_bag", changed(CIRCLE, ('circle = "circle"', 'circle = "square"')), 0, "in which the notebook"),
        ],
    ),
    Answers(
        "debugging-5",
        3,
        MILEAGE,
        [
            Wrong("teleport", changed(MILEAGE, ("if step <= 0.2", "if step <= 1e9")), 2, "Leave out a step"),
            Wrong(
                "stuck",
                changed(
                    MILEAGE,
                    ("        self.before = here\n", ""),
                    ("way += step\n", "way += step\n            self.before = here\n"),
                ),
                2,
                "go on from where",
            ),
            Wrong(
                "no_first",
                changed(MILEAGE, ("        self.publisher.publish", "        if step: self.publisher.publish")),
                2,
                "also for the first one",
            ),
            Wrong("no_before", changed(MILEAGE, (" if self.before else 0.0", "")), 0, "61 poses there were 0 messages"),
        ],
    ),
    Answers(
        "debugging-6",
        5,
        PATIENTS,
        [
            Wrong("cause", changed(PATIENTS, ('"clock"', '"deadlock"')), 4, "send nothing at all"),
            Wrong("no_id", changed(PATIENTS, ('"not_sourced"', '"sourcing"')), 4, "faults.catalogue()"),
            Wrong(
                "not_repaired",
                changed(PATIENTS, ('start("ros2 run patrol map_server", name="map_server")\n', "")),
                3,
                "the map",
            ),
        ],
    ),
    Answers(
        "debugging-7",
        5,
        MONITOR,
        [
            Wrong("no_stale", changed(MONITOR, ("STALE if came == 0 else DiagnosticStatus.WARN", "WARN")), 4, "STALE"),
            Wrong(
                "grows",
                changed(MONITOR, ("came, self.counts[topic] = self.counts[topic], 0", "came = self.counts[topic]")),
                3,
                "at a third",
            ),
            Wrong("names", changed(MONITOR, ("name=topic", "name=topic[1:]")), 1, "with the topic as its name"),
            Wrong("no_rate", changed(MONITOR, (", values=[value]", "")), 4, "KeyValue"),
        ],
    ),
]
