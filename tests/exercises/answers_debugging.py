"""Answers to chapter 6's exercises: one that is right, and wrong ones that students give."""

from __future__ import annotations

import math

from tests.exercises import (
    answers_debugging_logs,
    answers_debugging_mileage,
    answers_debugging_monitor,
    answers_debugging_watchdog,
)
from tests.exercises.chapter import Answers, Wrong, changed, worked

KEEPS = "\nstop()" + worked("debugging-1")

# A level that an answer before it has set stays in the kernel.

CIRCLE = worked("debugging-4")

DRIVE = """
stop()

class Driver(Node):
    def __init__(self):
        super().__init__("driver")
        self.forward, self.turning = 0.0, 0.0
        self.publisher = self.create_publisher(Twist, "turtle1/cmd_vel", 10)
        self.create_timer(0.1, self.tick)

    def tick(self):
        twist = Twist()
        twist.linear.x, twist.angular.z = self.forward, self.turning
        self.publisher.publish(twist)

def drive(forward, turning, seconds):
    driver.forward, driver.turning = forward, turning
    time.sleep(seconds)

turtlesim, driver = run(TurtleSim), run(Driver)
"""

# Through the field, a rest, two rounds to the right, the turtle's own bag format; its path as an object.
ROUNDS = f"""{DRIVE}
with bags.record("rounds", "turtle1/pose", "turtle1/cmd_vel", storage="sqlite3", overwrite=True) as bag:
    drive(1.5, 0.0, 1.0)
    drive(0.0, 0.0, 0.5)
    drive(-3.0, -3.0, 4.5)
stop()
circle = bag.path
"""

# One command a second holds just so long.
SELDOM = """
stop()
import pathlib

run(TurtleSim)
driver = run(Node, "driver")
publisher = driver.create_publisher(Twist, "turtle1/cmd_vel", 10)
twist = Twist()
twist.linear.x, twist.angular.z = 1.0, 1.0
with bags.record("circle", "/turtle1/pose", "/turtle1/cmd_vel", overwrite=True) as bag:
    wait_for(lambda: publisher.get_subscription_count() == 2)
    for _ in range(9):  # a whole circle takes more than six on a busy machine, too
        publisher.publish(twist)
        time.sleep(1.0)
stop()
circle = pathlib.Path("circle").resolve()
"""


def drives(*parts: tuple[float, float, float]) -> str:
    """A bag of a drive in parts: m/s, rad/s, seconds."""
    lines = "".join(f"    drive({forward}, {turning}, {seconds})\n" for forward, turning, seconds in parts)
    record = 'with bags.record("circle", "/turtle1/pose", "/turtle1/cmd_vel", overwrite=True):'
    return f'{DRIVE}\n{record}\n{lines}stop()\ncircle = "circle"\n'


PATIENTS = worked("debugging-6")

# As the manual starts it, but with a queue that is just long enough, and the planner anew.
SHORT_QUEUE = changed(
    PATIENTS,
    (
        'start("ros2 run patrol map_server", name="map_server")',
        'depth = "qos_overrides./scan.subscription.depth:=6"\n'
        'start(f"ros2 run patrol map_server --ros-args -p {depth}", name="map_server")\n'
        'start("ros2 run patrol planner --ros-args -r cmd_vel:=turtle1/cmd_vel", name="planner")',
    ),
)

ALL_ANEW = """
stop()
faults.stop()
from course_kit.exercises.faults.surroundings import source_robot
source_robot()
for program in ("simulator", "scanner", "map_server"):
    start(f"ros2 run patrol {program}", name=program)
start("ros2 run patrol planner --ros-args -r cmd_vel:=turtle1/cmd_vel -p speed:=0.8", name="planner")
seed_9, seed_31, seed_17 = ["not_sourced", "clock", "queue"]
"""

FOUR_PUBLISHERS = """
faults.stop()
from std_msgs.msg import Int32

class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.pose, self.counted = Pose(x=1.0, y=1.0, linear_velocity=1.0), 0
        self.poses = self.create_publisher(Pose, "turtle1/pose", 10)
        self.scans = self.create_publisher(LaserScan, "scan", 10)
        self.commands = self.create_publisher(Twist, "turtle1/cmd_vel", 10)
        self.counts = self.create_publisher(Int32, "map_scans", 10)
        self.create_timer(0.016, self.move)
        self.create_timer(0.1, self.work)
        self.create_timer(0.5, self.count)

    def move(self):
        self.pose.x = 1.0 + (self.pose.x - 1.0 + 0.016) % 9.0
        self.poses.publish(self.pose)

    def work(self):
        self.scans.publish(LaserScan(ranges=[2.0] * 36))
        self.commands.publish(Twist())

    def count(self):
        self.counted += 5
        self.counts.publish(Int32(data=self.counted))

run(Robot)
seed_9, seed_31, seed_17 = "not_sourced", "clock", "queue"
"""

FALSE_COUNT = """
stop()
faults.start(seed=17)
from std_msgs.msg import Int32

class Counter(Node):
    def __init__(self):
        super().__init__("counter")
        self.counted, self.counts = 0, self.create_publisher(Int32, "map_scans", 10)
        self.create_timer(0.5, self.count)

    def count(self):
        self.counted += 5
        self.counts.publish(Int32(data=self.counted))

queue_of_one = "--ros-args -p qos_overrides./scan.subscription.depth:=1 -r map_scans:=elsewhere"
start(f"ros2 run patrol map_server {queue_of_one}", name="map_server")
run(Counter)
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
            Wrong("both", changed(KEEPS, ('"/speed_limit"', '["/speed_limit", "/scan"]')), 1, "You gave ["),
        ],
        {
            "no_slash": 'kept, lossy = "speed_limit", " scan"',
            "alone": 'import numpy as np\nkept, lossy = {"/speed_limit"}, np.array(["/scan"])',
            "hidden": changed(KEEPS, ('"/speed_limit"', '"/turtle1/rotate_absolute/_action/status"')),
        },
    ),
    answers_debugging_logs.ANSWERS,
    Answers(
        "debugging-4",
        2,
        CIRCLE,
        [
            Wrong("topics", changed(CIRCLE, (', "/turtle1/cmd_vel", over', ", over")), 1, "name the topics"),
            Wrong("slow", changed(CIRCLE, ("2.0, 1.2", "0.5, 0.4")), 1, "A circle takes"),
            Wrong("no_bag", changed(CIRCLE, ('circle = "circle"', 'circle = "square"')), 0, "in which the notebook"),
            Wrong(
                "all_topics",
                changed(CIRCLE, ('"/turtle1/pose", "/turtle1/cmd_vel", ', ""), ("440", "1000")),
                1,
                "name the topics",
            ),
            Wrong("short", changed(CIRCLE, ("2.0, 1.2", "2.0, 3.0"), ("440", "200")), 1, "drive while it records"),
            Wrong("spins", drives((2.0, 0.0, 2.0), (0.0, 3.0, 4.0)), 1, "drive and turn at the same time"),
            Wrong("too_slow", drives((2.0, 0.0, 1.0), (0.8, 1.5, 7.0)), 1, "0.8 m/s where it is slowest"),
            Wrong("square", drives(*[(2.0, 0.0, 1.0), (0.0, math.pi / 2, 1.0)] * 4), 1, "never round on one circle"),
            Wrong("spiral", drives(*[(1.0 + 0.5 * n, 1.5, 0.7) for n in range(8)]), 1, "never round on one circle"),
        ],
        {"path": changed(CIRCLE, ('circle = "circle"', "circle = bag.path")), "rounds": ROUNDS, "seldom": SELDOM},
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
            Wrong("four_publishers", FOUR_PUBLISHERS, 3, "its scans are from where its turtle is put"),
            Wrong("false_count", FALSE_COUNT, 3, "twice the scans get into the map"),
        ],
        {"short_queue": SHORT_QUEUE, "all_anew": ALL_ANEW},
    ),
    answers_debugging_watchdog.ANSWERS,
    answers_debugging_mileage.ANSWERS,
    answers_debugging_monitor.ANSWERS,
]
