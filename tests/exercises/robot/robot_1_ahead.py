"""Answers to robot-1: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

AHEAD = worked("robot-1")

BY_HAND = """
class AheadOfRobot(Node):
    def __init__(self):
        Node.__init__(self, "ahead_of_robot")
        self.buffer = Buffer(node=self)
        self.listener = TransformListener(self.buffer, self)
        self.points = self.create_publisher(PointStamped, "/ahead_of_robot", qos_profile_sensor_data)
        self.timer = self.create_timer(1 / 5, self.say)

    def say(self):
        if not self.buffer.can_transform("odom", "base_link", Time()):
            return
        there = self.buffer.lookup_transform("odom", "base_link", Time()).transform
        x, y = seen_from((there.translation.x, there.translation.y, heading(there.rotation)), 1.0, 0.0)
        message = PointStamped()
        message.header.frame_id, message.header.stamp = "odom", self.get_clock().now().to_msg()
        message.point.x, message.point.y = x, y
        self.points.publish(message)
"""
FROM_ODOMETRY = """
class AheadOfRobot(Node):
    def __init__(self):
        super().__init__("ahead_of_robot")
        self.last = None
        self.points = self.create_publisher(PointStamped, "ahead_of_robot", 10)
        self.create_subscription(Odometry, "odom", self.keep, 10)
        self.create_timer(0.2, self.tick)

    def keep(self, message):
        self.last = message

    def tick(self):
        if self.last is None:
            return
        pose = self.last.pose.pose
        angle = heading(pose.orientation)
        point = PointStamped(header=self.last.header)
        point.point.x, point.point.y = pose.position.x + math.cos(angle), pose.position.y + math.sin(angle)
        self.points.publish(point)
"""
LOOKED_UP = 'there = self.buffer.lookup_transform("odom", "base_link", Time())'
FIXED = [
    (f"            {LOOKED_UP}\n", "            self.there = getattr(self, 'there', None) or self.look()\n"),
    (", there))", ", self.there))\n\n    def look(self):\n        " + LOOKED_UP.replace("there =", "return")),
]
DEGREES = (
    "self.points.publish(do_transform_point(ahead, there))",
    "at, turn = there.transform.translation, math.degrees(heading(there.transform.rotation))\n"
    "        ahead.header = there.header\n"
    "        ahead.point.x, ahead.point.y = seen_from((at.x, at.y, turn), 1.0, 0.0)\n"
    "        self.points.publish(ahead)",
)
NOT_TRANSFORMED = (
    "self.points.publish(do_transform_point(ahead, there))",
    'ahead.header = there.header\n        ahead.header.frame_id = "odom"\n        self.points.publish(ahead)',
)

ANSWERS = Answers(
    "robot-1",
    2,
    AHEAD,
    [
        Wrong("swapped", changed(AHEAD, ('"odom", "base_link"', '"base_link", "odom"')), 0, "Their header says"),
        Wrong("degrees", changed(AHEAD, DEGREES), 1, "in degrees"),
        Wrong(
            "frame",
            changed(
                AHEAD,
                (
                    "self.points.publish(do_transform_point(ahead, there))",
                    "seen = do_transform_point(ahead, there)\n"
                    '        seen.header.frame_id = "base_link"\n        self.points.publish(seen)',
                ),
            ),
            0,
            "Their header says 'base_link'",
        ),
        Wrong("fixed", changed(AHEAD, *FIXED), 1, "Look the transform up for each"),
        Wrong("not_transformed", changed(AHEAD, NOT_TRANSFORMED), 1, "as it is in base_link"),
        Wrong("itself", changed(AHEAD, ("ahead.point.x = 1.0", "ahead.point.x = 0.0")), 1, "the robot itself"),
        Wrong("aside", changed(AHEAD, ("ahead.point.x", "ahead.point.y")), 1, "y to the left"),
        Wrong("ten_a_second", changed(AHEAD, ("0.2, self.tick", "0.1, self.tick")), 1, "for each second of these"),
    ],
    {"by_hand": BY_HAND, "from_odometry": FROM_ODOMETRY},
)
