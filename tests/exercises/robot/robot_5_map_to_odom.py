"""Answers to robot-5: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

MAP_TO_ODOM = worked("robot-5")

MATRICES = """
from geometry_msgs.msg import TransformStamped
from rclpy.duration import Duration
from tf2_ros import TransformBroadcaster

def matrix(x, y, q):
    angle = 2 * math.atan2(q.z, q.w)
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, x], [s, c, y], [0, 0, 1]])

class MapToOdom(Node):
    def __init__(self):
        super().__init__("map_to_odom")
        self.tf = Buffer()
        self.ear = TransformListener(self.tf, self)
        self.mouth = TransformBroadcaster(self)
        self.create_subscription(PoseStamped, "/pose_on_map", self.correct, 1)

    def correct(self, message):
        when = Time.from_msg(message.header.stamp)
        if not self.tf.can_transform("base_link", "odom", when):
            return
        odom_seen_from_base = self.tf.lookup_transform("base_link", "odom", when).transform
        a = matrix(message.pose.position.x, message.pose.position.y, message.pose.orientation)
        b = odom_seen_from_base.translation
        m = a @ matrix(b.x, b.y, odom_seen_from_base.rotation)
        t = TransformStamped(child_frame_id="odom")
        t.header.frame_id = "map"
        t.header.stamp = (when + Duration(seconds=0.4)).to_msg()
        t.transform.translation.x, t.transform.translation.y = m[0, 2], m[1, 2]
        half = math.atan2(m[1, 0], m[0, 0]) / 2
        t.transform.rotation.z, t.transform.rotation.w = math.sin(half), math.cos(half)
        self.mouth.sendTransform([t])
"""

STEADY = """
from tf2_ros import TransformBroadcaster

class Listening(Node):
    def __init__(self, name):
        super().__init__(name)
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)

class MapToOdom(Listening):
    def __init__(self):
        super().__init__("map_to_odom")
        self.odom = None
        self.broadcaster = TransformBroadcaster(self)
        self.create_subscription(PoseStamped, "pose_on_map", self.take, 10)
        self.create_timer(0.05, self.tell)

    async def take(self, pose):
        when = Time.from_msg(pose.header.stamp)
        await self.buffer.wait_for_transform_async("odom", "base_link", when)
        found = self.buffer.lookup_transform("odom", "base_link", when)
        self.odom = after(place_of(pose.pose), inverse(place_of(found.transform)))

    def tell(self):
        if self.odom is not None:
            now = self.get_clock().now().to_msg()
            self.broadcaster.sendTransform(transform_of(self.odom, "map", "odom", now))
"""

ANSWERS = Answers(
    "robot-5",
    4,
    MAP_TO_ODOM,
    [
        Wrong(
            "old_transform",
            changed(MAP_TO_ODOM, ('"base_link", Time.from_msg(stamp)', '"base_link", Time()')),
            2,
            "Look it up at that time",
        ),
        Wrong(
            "odometry_for_truth",
            changed(MAP_TO_ODOM, ("after(place_of(pose.pose), inverse(place_of(found.transform)))", "(0.0, 0.0, 0.0)")),
            1,
            "odometry taken for truth",
        ),
        Wrong(
            "second_parent",
            changed(
                MAP_TO_ODOM,
                ("after(place_of(pose.pose), inverse(place_of(found.transform)))", "place_of(pose.pose)"),
                ('"map", "odom", stamp', '"map", "base_link", stamp'),
            ),
            0,
            "base_link has a parent already",
        ),
        Wrong(
            "the_pose_itself",
            changed(
                MAP_TO_ODOM,
                ("after(place_of(pose.pose), inverse(place_of(found.transform)))", "place_of(pose.pose)"),
            ),
            1,
            "that is the pose, base_link in the map",
        ),
        Wrong(
            "inverse_forgotten",
            changed(MAP_TO_ODOM, ("inverse(place_of(found.transform))", "place_of(found.transform)")),
            1,
            "the inverse is missing",
        ),
        Wrong(
            "the_way_back",
            changed(
                MAP_TO_ODOM,
                (
                    "after(place_of(pose.pose), inverse(place_of(found.transform)))",
                    "after(place_of(found.transform), inverse(place_of(pose.pose)))",
                ),
            ),
            1,
            "the map seen from odom",
        ),
        Wrong(
            "subtracted",
            changed(
                MAP_TO_ODOM,
                (
                    "after(place_of(pose.pose), inverse(place_of(found.transform)))",
                    "tuple(a - b for a, b in zip(place_of(pose.pose), place_of(found.transform)))",
                ),
            ),
            1,
            "as if the map were not turned",
        ),
        Wrong(
            "quaternion",
            changed(
                MAP_TO_ODOM,
                (
                    "        self.broadcaster.send",
                    "        told = transform_of(odom, 'map', 'odom', stamp)\n"
                    "        told.transform.rotation.z, told.transform.rotation.w = odom[2], 1.0\n"
                    "        self.broadcaster.send",
                ),
                ('transform_of(odom, "map", "odom", stamp)', "told"),
            ),
            1,
            "z=sin(angle/2) and w=cos(angle/2)",
        ),
        Wrong(
            "degrees",
            changed(
                MAP_TO_ODOM,
                ('transform_of(odom, "map"', 'transform_of((odom[0], odom[1], math.degrees(odom[2])), "map"'),
            ),
            1,
            "A turn by an angle in radians",
        ),
        Wrong(
            "once",
            changed(
                MAP_TO_ODOM,
                ("        odom = after", "        self.odom = getattr(self, 'odom', None) or after"),
                ("transform_of(odom,", "transform_of(self.odom,"),
            ),
            3,
            "compute anew for each pose",
        ),
        Wrong("frames_swapped", changed(MAP_TO_ODOM, ('"map", "odom", stamp', '"odom", "map", stamp')), 0, "one root"),
        Wrong("no_stamp", changed(MAP_TO_ODOM, ('"odom", stamp', '"odom", Time().to_msg()')), 0, "One is stamped 0"),
        Wrong("topic", changed(MAP_TO_ODOM, ('"pose_on_map"', '"pose"')), 0, "Your node subscribes to"),
    ],
    {"matrices_ahead": MATRICES, "steadily": STEADY},
)
