"""Answers to robot-4: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

MAP = worked("robot-4")

OWN_GRID = """
class MapMaker(Node):
    def __init__(self):
        super().__init__("map_maker")
        self.odds, self.scans = np.zeros((500, 600)), []  # from (-10, -8) on
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.maps = self.create_publisher(OccupancyGrid, "/map", KEPT)
        self.create_subscription(LaserScan, "scan", self.scans.append, qos_profile_sensor_data)
        self.create_timer(0.1, self.look)
        self.create_timer(1.5, self.tell)

    def look(self):
        while self.scans:
            stamp = Time.from_msg(self.scans[0].header.stamp)
            if not self.buffer.can_transform("map", "base_scan", stamp):
                if len(self.scans) < 5:
                    return
                self.scans.pop(0)
                continue
            there = self.buffer.lookup_transform("map", "base_scan", stamp).transform
            self.add(self.scans.pop(0), there.translation.x, there.translation.y, heading(there.rotation))

    def add(self, scan, x, y, turn):
        ranges = np.array(scan.ranges)
        angles = turn + np.arange(360) * scan.angle_increment
        ways = np.arange(0.0, 3.4, 0.02)
        far = np.where(np.isposinf(ranges), scan.range_max, np.nan_to_num(ranges, neginf=0.0))
        passed = ways[None] < far[:, None] - 0.05
        free = np.zeros(self.odds.shape, bool)
        free[self.cells(x, y, angles[:, None], ways[None], passed)] = True
        hit = np.isfinite(ranges) & (ranges > 0.12)
        walls = np.zeros(self.odds.shape, bool)
        walls[self.cells(x, y, angles, ranges, hit)] = True
        self.odds = np.clip(self.odds + 0.9 * walls - 0.4 * (free & ~walls), -5, 5)

    def cells(self, x, y, angles, ways, which):
        with np.errstate(invalid="ignore"):
            across, up = x + ways * np.cos(angles) + 10, y + ways * np.sin(angles) + 8
        return (up[which] // 0.05).astype(int), (across[which] // 0.05).astype(int)

    def tell(self):
        percent = np.rint(100 / (1 + np.exp(-self.odds))).astype(np.int8)
        message = OccupancyGrid()
        message.header.frame_id = "map"
        message.info.resolution, message.info.width, message.info.height = 0.05, 600, 500
        message.info.origin.position.x, message.info.origin.position.y = -10.0, -8.0
        message.data = np.where(self.odds == 0, -1, percent).astype(np.int8).ravel().tolist()
        self.maps.publish(message)
"""
GIVEN_PARTS = """
from course_kit.robots.navigation.frames import Frames, PlacedScans
from course_kit.robots.navigation.messages import map_message, rays_of

class MapMaker(Node):
    def __init__(self):
        super().__init__("map_maker")
        self.grid = Grid()
        self.frames = Frames(self, lambda: None)
        self.scans = PlacedScans(self, self.frames, "map", self.take)
        self.maps = self.create_publisher(OccupancyGrid, "map", KEPT)
        self.create_timer(1.0, self.tell)

    def take(self, scan, place):
        self.grid.add(place, *rays_of(scan), scan.range_max)

    def tell(self):
        if self.grid.log_odds.size:
            self.maps.publish(map_message(self.grid.map(), "map", self.get_clock().now().to_msg()))
"""
ORIGIN = "message.info.origin.position.x, message.info.origin.position.y = self.grid.origin"

ANSWERS = Answers(
    "robot-4",
    4,
    MAP,
    [
        Wrong("upside_down", changed(MAP, ("cells.ravel()", "cells[::-1].ravel()")), 2, "It is upside down"),
        Wrong("transposed", changed(MAP, ("cells.ravel()", "cells.T.ravel()")), 2, "Rows and columns are swapped"),
        Wrong("origin", changed(MAP, (ORIGIN, "pass")), 2, "It is shifted by"),
        Wrong(
            "odometry_for_truth",
            changed(MAP, ('lookup_transform("map"', 'lookup_transform("odom"')),
            2,
            "those of odom",
        ),
        Wrong(
            "inf_is_a_wall",
            changed(
                MAP,
                (
                    "ranges[ranges < scan.range_min] = np.nan",
                    "ranges = np.minimum(np.where(ranges < scan.range_min, np.nan, ranges), scan.range_max)",
                ),
            ),
            3,
            "has hit nothing",
        ),
        Wrong("volatile", changed(MAP, ('"map", kept)', '"map", 10)')), 3, "is volatile"),
        Wrong("no_frame", changed(MAP, ('stamp = "map", self', 'stamp = "", self')), 0, "frame is ''"),
        Wrong(
            "degrees",
            changed(MAP, ("heading(laser.rotation)", "math.degrees(heading(laser.rotation))")),
            2,
            "in radians",
        ),
    ],
    {"own_grid": OWN_GRID, "given_parts": GIVEN_PARTS},
    together=5,
)
