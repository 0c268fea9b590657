"""Answers to robot-2: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

WALL = worked("robot-2")

ASYNC_WALL = """
class NearestWall(Node):
    def __init__(self):
        super().__init__("nearest_wall")
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self, spin_thread=False)
        self.out = self.create_publisher(PointStamped, "nearest_wall", 10)
        self.create_subscription(LaserScan, "scan", self.hear, 10 and qos_profile_sensor_data)

    def hear(self, scan):
        hits = [(r, n) for n, r in enumerate(scan.ranges) if scan.range_min <= r <= scan.range_max]
        try:
            there = self.buffer.lookup_transform("odom", "base_scan", scan.header.stamp)
        except TransformException as error:
            self.get_logger().warning(str(error))
            return
        distance, number = min(hits)
        angle = scan.angle_min + number * scan.angle_increment
        place = there.transform.translation.x, there.transform.translation.y, heading(there.transform.rotation)
        point = PointStamped(header=there.header)
        point.point.x, point.point.y = seen_from(place, distance * math.cos(angle), distance * math.sin(angle))
        self.out.publish(point)
"""
WAITING = """
class NearestWall(Node):
    def __init__(self):
        super().__init__("nearest_wall")
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.publisher = self.create_publisher(PointStamped, "nearest_wall", 10)
        self.scans = []
        self.create_subscription(LaserScan, "scan", self.scans.append, qos_profile_sensor_data)
        self.create_timer(0.05, self.look)

    def look(self):
        for scan in list(self.scans):
            stamp = Time.from_msg(scan.header.stamp)
            if self.buffer.can_transform("odom", scan.header.frame_id, stamp):
                self.scans.remove(scan)
                self.tell(scan, self.buffer.lookup_transform("odom", scan.header.frame_id, stamp))
        del self.scans[:-5]

    def tell(self, scan, there):
        ranges = np.array([r if scan.range_min <= r <= scan.range_max else np.inf for r in scan.ranges])
        n = int(ranges.argmin())
        hit = PointStamped(header=scan.header)
        hit.point.x = float(ranges[n]) * math.cos(n * scan.angle_increment)
        hit.point.y = float(ranges[n]) * math.sin(n * scan.angle_increment)
        self.publisher.publish(do_transform_point(hit, there))
"""
IS_HIT = "(ranges >= scan.range_min) & (ranges <= scan.range_max)"

ANSWERS = Answers(
    "robot-2",
    3,
    WALL,
    [
        Wrong(
            "latest",
            changed(WALL, ("Time.from_msg(scan.header.stamp)", "Time()")),
            0,
            "have a point with their stamp",
        ),
        Wrong(
            "latest_with_the_scans_stamp",
            changed(
                WALL,
                ("stamp = Time.from_msg(scan.header.stamp)", "stamp = Time()"),
                (
                    "self.points.publish(do_transform_point(hit, there))",
                    "seen = do_transform_point(hit, there)\n        seen.header.stamp = scan.header.stamp\n"
                    "        self.points.publish(seen)",
                ),
            ),
            1,
            "if the scan were new",
        ),
        Wrong("no_laser_offset", changed(WALL, ("scan.header.frame_id, stamp", '"base_link", stamp')), 1, "3 cm"),
        Wrong("raises", changed(WALL, ("except TransformException", "except ZeroDivisionError")), 2, "raised"),
        Wrong("minimum_of_all", changed(WALL, (IS_HIT, "~np.isnan(ranges)")), 2, "A hit is between"),
        Wrong("only_finite", changed(WALL, (IS_HIT, "np.isfinite(ranges)")), 2, "A hit is between"),
        Wrong("degrees", changed(WALL, ("* scan.angle_increment", "* 1.0")), 1, "in radians"),
        Wrong("reliable", changed(WALL, ("qos_profile_sensor_data", "10")), 0, "asks for RELIABLE"),
    ],
    {"message_stamp": ASYNC_WALL, "waits_in_a_list": WAITING},
)
