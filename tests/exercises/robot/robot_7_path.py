"""Answers to robot-7: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

PATH = worked("robot-7")
X = "pose.pose.position.x = self.info.origin.position.x + (column + 0.5) * self.info.resolution"
Y = "pose.pose.position.y = self.info.origin.position.y + (row + 0.5) * self.info.resolution"

GIVEN = """
from course_kit import map_of, path_message
from course_kit import CostMap, PlanError, plan
from nav_msgs.msg import OccupancyGrid, Path
from rclpy.qos import DurabilityPolicy, QoSProfile
from nav_msgs.srv import GetPlan

class PathFinder(Node):
    def __init__(self):
        super().__init__("path_finder")
        qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.map = None
        self.create_subscription(OccupancyGrid, "/map", self.keep, qos)
        self.create_service(GetPlan, "/get_plan", self.plan)

    def keep(self, message):
        self.map = map_of(message)

    def plan(self, request, response):
        start, goal = (place_of(one.pose) for one in (request.start, request.goal))
        try:
            points = plan(CostMap(self.map, 0.12), start[:2], goal[:2])
            response.plan = path_message(points, goal[2], "map", self.get_clock().now().to_msg())
        except PlanError as refused:
            self.get_logger().warning(str(refused))
            response.plan = Path()
        return response
"""

FLOOD = """
from collections import deque
from nav_msgs.msg import OccupancyGrid, Path
from rclpy.qos import DurabilityPolicy, QoSProfile
from nav_msgs.srv import GetPlan

class PathFinder(Node):
    '''The way by a flood from the goal: each free cell knows how many steps it is away.'''

    def __init__(self):
        super().__init__("path_finder")
        self.create_subscription(OccupancyGrid, "map", lambda m: setattr(self, "map", m), QoSProfile(
            depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL))
        self.create_service(GetPlan, "get_plan", self.answer)

    def answer(self, request, response):
        info, w, h = self.map.info, self.map.info.width, self.map.info.height
        r = math.ceil(0.11 / info.resolution)
        near = [(i, j) for i in range(-r, r + 1) for j in range(-r, r + 1) if math.hypot(i, j) * info.resolution < 0.11]
        grid = np.zeros((h, w), bool)
        for index, value in enumerate(self.map.data):
            if value < 0 or value >= 65:
                for i, j in near:
                    row, column = index // w + i, index % w + j
                    if 0 <= row < h and 0 <= column < w:
                        grid[row, column] = True
        def cell(p):
            return (int((p.x - info.origin.position.x) // info.resolution),
                    int((p.y - info.origin.position.y) // info.resolution))
        start, goal = cell(request.start.pose.position), cell(request.goal.pose.position)
        response.plan.header.frame_id = "map"
        steps, waiting = {goal: None}, deque([goal])
        while waiting and start not in steps:
            x, y = waiting.popleft()
            for dx, dy in ((1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (1, -1), (-1, -1)):
                n = (x + dx, y + dy)
                if 0 <= n[0] < w and 0 <= n[1] < h and not grid[n[1], n[0]] and n not in steps:
                    steps[n] = (x, y)
                    waiting.append(n)
        if start not in steps or not (0 <= goal[0] < w and 0 <= goal[1] < h) or grid[goal[1], goal[0]]:
            return response
        while start is not None:
            one = PoseStamped()
            one.pose.position.x = info.origin.position.x + (start[0] + 0.5) * info.resolution
            one.pose.position.y = info.origin.position.y + (start[1] + 0.5) * info.resolution
            response.plan.poses.append(one)
            start = steps[start]
        return response
"""

ANSWERS = Answers(
    "robot-7",
    4,
    PATH,
    [
        Wrong("not_inflated", changed(PATH, ("far >= 0.11", "far > 0")), 3, "The robot is no point"),
        Wrong(
            "through_the_unknown", changed(PATH, ("(cells >= 65) | (cells < 0)", "cells >= 65")), 3, "in a cell of -1"
        ),
        Wrong("black_cells_only", changed(PATH, ("cells >= 65", "cells == 100")), 3, "in a wall, of"),
        Wrong("in_cells", changed(PATH, ("far >= 0.11", "far >= 11")), 0, "the plan has 0 poses"),
        Wrong(
            "cells_for_metres",
            changed(PATH, (X, "pose.pose.position.x = float(column)"), (Y, "pose.pose.position.y = float(row)")),
            0,
            "those are cells",
        ),
        Wrong(
            "origin_forgotten",
            changed(
                PATH,
                ("self.info.origin.position.x + (column", "(column"),
                ("self.info.origin.position.y + (row", "(row"),
            ),
            0,
            "the map's origin is missing",
        ),
        Wrong(
            "x_for_row",
            changed(
                PATH,
                ("position.x = self", "position.z = self"),
                ("position.y = self", "position.x = self"),
                ("position.z = self", "position.y = self"),
            ),
            0,
            "x and y are exchanged",
        ),
        Wrong(
            "greedy",
            changed(
                PATH, ("total < spent.get(there, math.inf)", "there not in spent"), ("total + math.dist", "math.dist")
            ),
            3,
            "greedy",
        ),
        Wrong(
            "four_neighbours",
            changed(PATH, (", (1, 1), (1, -1), (-1, 1), (-1, -1)]", "]")),
            3,
            "one of eight neighbours",
        ),
        Wrong("straight", changed(PATH, ("way(self.free, start, goal) if", "[start, goal] if")), 0, "m apart"),
        Wrong(
            "crashes_on_none",
            changed(PATH, ("    return []\n", "    raise ValueError('no way')\n")),
            3,
            "no answer came",
        ),
        Wrong(
            "nearest_instead",
            changed(PATH, ("    return []\n", "    return [start, goal]\n"), (" if goal in self.free else []", "")),
            3,
            "an empty Path says",
        ),
        Wrong(
            "keeps_first_map",
            changed(
                PATH,
                (
                    "        self.info = message",
                    "        if hasattr(self, 'info'):\n            return\n        self.info = message",
                ),
            ),
            0,
            "plan on the newest",
        ),
        Wrong("never_hears_the_map", changed(PATH, ('"map", self', '"maps", self')), 0, "`/map` has no subscription"),
    ],
    {"given_parts": GIVEN, "flood": FLOOD},
)
