"""Answers to debugging-6: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

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
from course_kit.exercises.faults.terminals import source_robot
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

ANSWERS = Answers(
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
)
