"""Answers to debugging-2: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

QUIET = "\nstop()" + worked("debugging-2")

TELLS = "        self.get_logger().info(text"

IS_DETAILED = "self.get_logger().get_effective_level() == 10"

LOUD_AT_DEBUG = f"        if {IS_DETAILED}: self.get_logger().info(text)\n        else: self.get_logger().info(text"

CHILD = """
from rclpy.logging import LoggingSeverity, set_logger_level
stop()
set_logger_level("quiet", LoggingSeverity.INFO)
from rclpy.qos import qos_profile_sensor_data as anyhow

class Quiet(Node):
    def __init__(self):
        Node.__init__(self, "quiet", enable_logger_service=True)
        self.told, self.details = None, self.get_logger().get_child("pose")
        self.create_subscription(Pose, "/turtle1/pose", self.on_pose, anyhow)
        self.get_logger().info("I tell where the turtle is")

    def on_pose(self, pose):
        self.details.debug(f"{pose}")
        now = self.get_clock().now()
        if self.told is None or (now - self.told).nanoseconds >= 1_000_000_000:
            self.details.info(f"x = {pose.x}")
            self.told = now

turtlesim, quiet = run(TurtleSim), run(Quiet)
"""

TIMER = """
from rclpy.logging import LoggingSeverity, set_logger_level
stop()
set_logger_level("quiet", LoggingSeverity.INFO)
from rclpy.lifecycle import LifecycleNode

class Quiet(LifecycleNode):
    def __init__(self):
        super().__init__("quiet", enable_logger_service=True)
        self.last = None
        self.create_subscription(Pose, "turtle1/pose", self.on_pose, 50)
        self.create_timer(1.0, self.tell)

    def on_pose(self, pose):
        self.last = pose
        self.get_logger().debug(f"at {pose.x:.3f} m, {pose.y:.3f} m")

    def tell(self):
        if self.last is not None:
            self.get_logger().info(f"x = {self.last.x:.1f} m")
            self.get_logger().warning("the turtle has no brakes", throttle_duration_sec=2.0)

turtlesim, quiet = run(TurtleSim), run(Quiet)
"""

DRIVEN = """
from rclpy.logging import LoggingSeverity, set_logger_level
stop()
set_logger_level("quiet", LoggingSeverity.INFO)
import threading
from rclpy.executors import MultiThreadedExecutor

class Quiet(Node):
    def __init__(self):
        super().__init__("quiet", enable_logger_service=True)
        self.create_subscription(Pose, "turtle1/pose", self.on_pose, 10)

    async def on_pose(self, pose):
        self.get_logger().debug("x = %.2f" % pose.x)
        self.get_logger().info("x = %.2f" % pose.x, throttle_duration_sec=2.5)

class Driver(Node):
    def __init__(self):
        super().__init__("driver")
        self.publisher = self.create_publisher(Twist, "turtle1/cmd_vel", 10)
        self.create_timer(0.1, self.tick)

    def tick(self):
        twist = Twist()
        twist.linear.x, twist.angular.z = 1.0, 1.0
        self.publisher.publish(twist)

turtlesim, quiet, driver = run(TurtleSim), run(Quiet), run(Driver)
"""


ANSWERS = Answers(
    "debugging-2",
    3,
    QUIET,
    [
        Wrong("loud", changed(QUIET, (", throttle_duration_sec=1.0", "")), 2, "throttle_duration_sec=1.0"),
        Wrong("no_service", changed(QUIET, (", enable_logger_service=True", "")), 1, "enable_logger_service=True"),
        Wrong("no_debug", changed(QUIET, ("        self.get_logger().debug(text)\n", "")), 2, "`debug(…)` for"),
        Wrong("no_turtle", changed(QUIET, ("turtlesim, quiet = run(TurtleSim), run", "quiet = run")), 0, "run(Tur"),
        Wrong("y", changed(QUIET, ("{pose.x:.2f}", "{pose.y:.2f}")), 1, "log `pose.x` of the message"),
        Wrong("constant", changed(QUIET, ("info(text", 'info("x = 5.54"')), 2, "no pose with the x of 'x = 5.54'"),
        Wrong("fast", changed(QUIET, ("sec=1.0", "sec=0.5")), 2, "leaves the others out"),
        Wrong("once", changed(QUIET, ("throttle_duration_sec=1.0", "once=True")), 2, "at least one in five seconds"),
        Wrong("warning", changed(QUIET, ("info(text", "warning(text")), 2, "not all of them as INFO"),
        Wrong(
            "others",
            changed(
                QUIET,
                (
                    "        self.get_logger().debug",
                    '        self.get_logger().info("pose")\n        self.get_logger().debug',
                ),
            ),
            2,
            "other lines as INFO",
        ),
        Wrong(
            "own_level",
            changed(QUIET, ("        text =", "        self.get_logger().set_level(10)\n        text =")),
            2,
            "Before its level was set",
        ),
        Wrong(
            "starts_at_debug",
            changed(
                QUIET,
                ("        self.create_sub", "        self.get_logger().set_level(10)\n        self.create_sub"),
            ),
            2,
            "Before its level was set",
        ),
        Wrong(
            "goes_on",
            changed(
                QUIET,
                (
                    "        self.get_logger().debug(text)",
                    "        if not hasattr(self, 'details'):  # a level stays: a name for each node\n"
                    "            name = f'at_{self.get_clock().now().nanoseconds}'\n"
                    "            self.details = self.get_logger().get_child(name)\n"
                    "        if self.get_logger().get_effective_level() == 10: self.details.set_level(10)\n"
                    "        self.details.debug(text)",
                ),
            ),
            2,
            "it goes on to log DEBUG",
        ),
        Wrong("loud_at_debug", changed(QUIET, (TELLS, LOUD_AT_DEBUG)), 2, "At the level DEBUG: In"),
        Wrong(
            "silent_at_debug",
            changed(QUIET, (TELLS, f"        if not {IS_DETAILED}: {TELLS.strip()}")),
            2,
            "at least one in five seconds",
        ),
        Wrong(
            "every_second",
            changed(QUIET, (".debug(text)", ".debug(text, skip_first=True, throttle_duration_sec=0.03)")),
            2,
            "of them have the x",
        ),
    ],
    {"child": CHILD, "timer": TIMER, "driven": DRIVEN},
)
