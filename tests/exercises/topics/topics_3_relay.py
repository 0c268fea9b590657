"""Answers to topics-3: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked
from tests.exercises.topics import styles

RELAY = worked("topics-3")

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


ANSWERS = Answers(
    "topics-3",
    3,
    RELAY,
    [
        Wrong("all", changed(RELAY, ("if self.count % 10 == 0:", "if True:")), 1, "count the calls of the callback"),
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
        Wrong("begins_with_the_20th", changed(RELAY, ("% 10 == 0", "% 10 == 0 and self.count > 10")), 2, "number 20"),
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
    together=11,
)
