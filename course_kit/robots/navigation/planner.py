"""The node planner: a path on /map that keeps away from walls, and from what the laser sees besides."""

from __future__ import annotations

import time
from collections import deque
from typing import Any

import numpy as np
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import OccupancyGrid, Path
from nav_msgs.srv import GetPlan
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from sensor_msgs.msg import LaserScan

from course_kit.robots.navigation.frames import Frames, PlacedScans
from course_kit.robots.navigation.grid_map import GridMap
from course_kit.robots.navigation.messages import LATCHED, map_of, path_message, place_of, rays_of
from course_kit.robots.navigation.places import Floats, Place, hits, moved
from course_kit.robots.navigation.planning import CostMap, plan

REMEMBERED = 25  # scans: 5 s of a TurtleBot's
# Seconds of real time for which a goal waits until tf tells where the robot is and somebody listens for the plan, who
# may have started at the same time, and from look to look.
WAIT, RETRY = 5.0, 0.1


class Planner(Node):
    """Plans to a goal on /goal_pose from where the robot is, or what the service get_plan asks, and publishes /plan.

    The service is there once a map is. Parameters: `robot_radius` and `margin` (m), `allow_unknown` (whether paths may
    lead where the map knows nothing), `map_frame`, `base_frame`. A goal that cannot be reached is refused in one line
    of its log, and by a plan without poses. Takes Node's keyword arguments.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__("planner", **options)
        self.frames = Frames(self, self.on_restart)
        self.radius = sum(self.declare_parameter(*one).value for one in (("robot_radius", 0.105), ("margin", 0.04)))
        self.allow_unknown = self.declare_parameter("allow_unknown", True).value
        self.map: GridMap | None = None
        self.seen: deque[Floats] = deque(maxlen=REMEMBERED)  # what scans have hit, in the map
        self.publisher = self.create_publisher(Path, "plan", 1)
        self.create_subscription(OccupancyGrid, "map", self.on_map, LATCHED)
        self.goal, self.asked = PoseStamped(), 0.0  # the last one, and when it came by time.monotonic()
        self.create_subscription(PoseStamped, "goal_pose", self.on_goal, 1)
        self.retry = self.create_timer(RETRY, self.plan_to_goal, clock=Clock(clock_type=ClockType.STEADY_TIME))
        self.retry.cancel()
        self.scans = PlacedScans(self, self.frames, self.frames.map, self.on_scan)

    def on_restart(self) -> None:
        """Forget what the laser has seen."""
        self.seen.clear()

    def on_map(self, message: OccupancyGrid) -> None:
        """Take over a map."""
        try:
            grid_map = map_of(message)
        except ValueError as error:
            self.get_logger().error(f"Cannot use /map: {error}")
            return
        if self.map is None:  # before, there was nothing to answer
            self.create_service(GetPlan, "get_plan", self.on_request)
        self.map = grid_map

    def on_scan(self, scan: LaserScan, laser: Place) -> None:
        """Remember what the laser sees, on the map."""
        self.seen.append(moved(hits(*rays_of(scan)), laser))

    def on_goal(self, goal: PoseStamped) -> None:
        """Plan from where the robot is to a goal, as soon as tf tells where that is and somebody listens."""
        self.goal, self.asked = goal, time.monotonic()
        self.plan_to_goal()

    def plan_to_goal(self) -> None:
        """Plan to the last goal, or look again a little later."""
        start = self.frames.place(self.frames.map, self.frames.base)
        is_heard = self.publisher.get_subscription_count() > 0
        if (start is None or not is_heard) and time.monotonic() - self.asked < WAIT:
            self.retry.reset()
            return
        self.retry.cancel()
        if start is None:
            self.get_logger().error(f"No plan: tf does not tell where {self.frames.base} is in {self.frames.map}")
        else:
            self.plan(start, self.goal)

    def on_request(self, request: GetPlan.Request, response: GetPlan.Response) -> GetPlan.Response:
        """Plan from a start to a goal."""
        response.plan = self.plan(place_of(request.start.pose), request.goal)
        return response

    def plan(self, start: Place, goal: PoseStamped) -> Path:
        """Plan from a place on the map to a goal in any frame; publish the path and return it."""
        now = self.get_clock().now().to_msg()
        path = Path()
        path.header.frame_id, path.header.stamp = self.frames.map, now
        try:
            end = self.frames.in_map(goal)
            points = plan(self.cost_map(), start[:2], end[:2])
            path = path_message(points, end[2], self.frames.map, now)
        except ValueError as refused:  # PlanError is one
            self.get_logger().error(f"No plan: {refused}")
        self.publisher.publish(path)
        return path

    def cost_map(self) -> CostMap:
        """What it costs to drive where, by the map and what the laser has seen."""
        if self.map is None:
            raise ValueError("no map has come on /map")
        points = np.vstack([np.zeros((0, 2)), *self.seen])
        return CostMap(self.map.with_hits(points), self.radius, self.allow_unknown)
