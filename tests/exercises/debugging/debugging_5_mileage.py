"""Answers to debugging-5: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

MILEAGE = worked("debugging-5")

IMPORT = "\nfrom std_msgs", "\nimport numpy as np\nfrom std_msgs"

COMPLEX = """
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import Float32

class Mileage(Node):
    def __init__(self):
        Node.__init__(self, "mileage")
        self.places, self.total = [], Float32()
        qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
        self.publisher = self.create_publisher(Float32, "/mileage", 1)
        self.create_subscription(Pose, "/turtle1/pose", self.on_pose, qos)

    def on_pose(self, pose):
        self.places = [*self.places[-1:], complex(pose.x, pose.y)]
        step = abs(self.places[-1] - self.places[0])
        self.total.data += 0.0 if step > 0.2 else step
        self.publisher.publish(self.total)
"""

ARRAYS = """
import numpy as np
from rclpy.lifecycle import LifecycleNode
from std_msgs.msg import Float32

class Mileage(LifecycleNode):
    def __init__(self):
        super().__init__("mileage")
        self.way = np.zeros((0, 2), np.float32)
        self.out = self.create_publisher(Float32, "mileage", 10)
        self.create_subscription(Pose, "turtle1/pose", self.on_pose, qos_profile_sensor_data)

    def on_pose(self, pose):
        self.way = np.vstack([self.way, [pose.x, pose.y]])
        steps = np.linalg.norm(np.diff(self.way, axis=0), axis=1)
        self.out.publish(Float32(data=float(steps[steps <= 0.2].sum())))
"""

WORKER = """
import queue
import threading
from std_msgs.msg import Float32

class Mileage(Node):
    def __init__(self):
        super().__init__("mileage")
        self.poses, self.driven, self.last = queue.Queue(), 0.0, None
        self.create_subscription(Pose, "turtle1/pose", self.poses.put, 10)
        self.publisher = self.create_publisher(Float32, "mileage", 10)
        threading.Thread(target=self.work, daemon=True).start()

    def work(self):
        while True:
            pose = self.poses.get()
            if self.last is not None:
                step = math.hypot(pose.x - self.last.x, pose.y - self.last.y)
                self.driven += step * (step <= 0.2)
            self.last = pose
            try:
                self.publisher.publish(Float32(data=self.driven))
            except Exception:
                return
"""

ANSWERS = Answers(
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
        Wrong("no_before", changed(MILEAGE, (" if self.before else 0.0", "")), 0, "poses there were 0 messages"),
        Wrong("one_metre", changed(MILEAGE, ("if step <= 0.2", "if step <= 1.0")), 2, "Leave out a step"),
        Wrong("too_strict", changed(MILEAGE, ("if step <= 0.2", "if step <= 0.19")), 1, "it added"),
        Wrong(
            "origin",
            changed(MILEAGE, ("self.before, self.way = None", "self.before, self.way = (0.0, 0.0)")),
            1,
            "the first of them 0.",
        ),
        Wrong(
            "where_turtles_begin",
            changed(MILEAGE, ("self.before, self.way = None", "self.before, self.way = (5.544445, 5.544445)")),
            1,
            "the first of them 0.",
        ),
        Wrong("counts", changed(MILEAGE, ("way += step", "way += 0.05")), 0, "Add `math.dist`"),
        Wrong(
            "one_for_all",
            changed(
                MILEAGE,
                ("(Node):\n", "(Node):\n    steps = []\n"),
                ("self.way += step", "self.steps.append(step)"),
                ("self.before = here", "self.before, self.way = here, sum(self.steps)"),
            ),
            1,
            "beginning with 0",
        ),
        Wrong("noise", changed(MILEAGE, ("if step <= 0.2", "if 0.01 <= step <= 0.2")), 1, "Add `math.dist`"),
        Wrong(
            "each_coordinate",
            changed(
                MILEAGE,
                ("if step <= 0.2", "if self.before and max(map(abs, np.subtract(here, self.before))) <= 0.2"),
                IMPORT,
            ),
            2,
            "Leave out a step",
        ),
        Wrong(
            "velocity",
            changed(MILEAGE, ("math.dist(here, self.before) if", "abs(pose.linear_velocity) * 0.016 if")),
            1,
            "of the places of one pose",
        ),
        Wrong(
            "backwards",
            changed(MILEAGE, ("self.way += step", "self.way += math.copysign(step, pose.linear_velocity)")),
            1,
            "Add `math.dist`",
        ),
        Wrong(
            "twice",
            changed(
                MILEAGE,
                ("data=self.way))\n", "data=self.way))\n        self.publisher.publish(Float32(data=self.way))\n"),
            ),
            2,
            "and once",
        ),
        Wrong(
            "timer",
            changed(
                MILEAGE,
                ("        self.publisher.publish(", "\n    def tell(self):\n        self.publisher.publish("),
                ("    def on_pose", "        self.create_timer(0.016, self.tell)\n\n    def on_pose"),
            ),
            2,
            "once for each pose",
        ),
    ],
    {"complex": COMPLEX, "arrays": ARRAYS, "worker": WORKER},
)
