"""Answers to robot-8: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

DRIVE_THERE = worked("robot-8")
CANCELED = "                self.drive(0.0, 0.0)\n                handle.canceled()"

# It blocks, in threads, at a rate of the node's clock; the given parts do the geometry.
IN_THREADS = """
import threading

import numpy as np
from geometry_msgs.msg import PoseStamped, TwistStamped
from nav2_msgs.action import NavigateToPose
from nav_msgs.srv import GetPlan
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from rclpy.time import Time
from sensor_msgs.msg import LaserScan
from tf2_ros import Buffer, TransformListener

from course_kit.robots.navigation.messages import place_of, points_of, rays_of, stamped_pose
from course_kit import hits, wrapped
from course_kit.robots.navigation.pursuit import Limits, Pursuit, room_ahead, turn

class DriveThere(Node):
    def __init__(self):
        super().__init__("drive_there")
        group = ReentrantCallbackGroup()
        self.limits, self.points, self.busy = Limits(), None, threading.Lock()
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.pub = self.create_publisher(TwistStamped, "/cmd_vel", 1)
        self.create_subscription(LaserScan, "/scan", self.look, qos_profile_sensor_data)
        self.cli = self.create_client(GetPlan, "/get_plan", callback_group=group)
        self.rate = self.create_rate(10.0)
        self.srv = ActionServer(self, NavigateToPose, "/navigate_to_pose", self.run_goal, callback_group=group,
                                cancel_callback=lambda goal: CancelResponse.ACCEPT)

    def look(self, scan):
        self.points = hits(*rays_of(scan)) + np.array([-0.032, 0.0])

    def send(self, v=0.0, w=0.0):
        command = TwistStamped()
        command.header.stamp = self.get_clock().now().to_msg()
        command.twist.linear.x, command.twist.angular.z = v, w
        self.pub.publish(command)

    def where(self):
        return place_of(self.buffer.lookup_transform("map", "base_link", Time(), Duration(seconds=5.0)).transform)

    def run_goal(self, handle):
        with self.busy:
            ended = self.travel(handle)
            self.send()
            getattr(handle, ended)()
            return NavigateToPose.Result()

    def travel(self, handle):
        goal, begin = handle.request.pose, self.where()
        answer = self.cli.call(GetPlan.Request(start=stamped_pose(begin, "map", goal.header.stamp), goal=goal))
        if not answer.plan.poses:
            return "abort"
        pursuit, there = Pursuit(points_of(answer.plan), self.limits), place_of(goal.pose)
        arrived, since, last = False, self.get_clock().now(), begin
        while not handle.is_cancel_requested:
            here = self.where()
            pursuit.pass_points(here)
            left = pursuit.remaining(here)
            handle.publish_feedback(NavigateToPose.Feedback(distance_remaining=left))
            arrived = arrived or np.hypot(here[0] - there[0], here[1] - there[1]) < 0.05
            off = wrapped(there[2] - here[2])
            if arrived and abs(off) < 0.05:
                return "succeed"
            v, w = 0.0, turn(off, self.limits)
            if not arrived and self.points is not None:
                beside = float(np.hypot(*self.points.T).min())
                v, w = pursuit.command(here, room_ahead(self.points, self.limits), beside)
            if arrived or np.hypot(here[0] - last[0], here[1] - last[1]) > 0.08:
                since, last = self.get_clock().now(), here
            if self.get_clock().now() - since > Duration(seconds=8.0):
                return "abort"
            self.send(v, w)
            self.rate.sleep()
        return "canceled"
"""

# A timer drives; `execute` waits for a future that says how it ended. It turns to the point with a proportional law.
BY_TIMER = """
import math

import numpy as np
from geometry_msgs.msg import TwistStamped
from nav2_msgs.action import NavigateToPose
from nav_msgs.srv import GetPlan
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from rclpy.task import Future
from rclpy.time import Time
from sensor_msgs.msg import LaserScan
from tf2_ros import Buffer, TransformException, TransformListener

class DriveThere(Node):
    def __init__(self, **options):
        super().__init__("drive_there", **options)
        self.job, self.near = None, 0.0
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.commands = self.create_publisher(TwistStamped, "cmd_vel", 10)
        self.plans = self.create_client(GetPlan, "get_plan")
        self.create_subscription(LaserScan, "scan", self.scanned, qos_profile_sensor_data)
        self.create_timer(0.05, self.step)
        self.action = ActionServer(self, NavigateToPose, "navigate_to_pose", self.execute,
                                   goal_callback=lambda g: GoalResponse.REJECT if self.job else GoalResponse.ACCEPT,
                                   cancel_callback=lambda h: CancelResponse.ACCEPT)

    def scanned(self, scan):
        ahead = [r for r in (*scan.ranges[:35], *scan.ranges[-35:]) if r > 0]
        self.near = min(ahead, default=9.0)

    def command(self, v, w):
        message = TwistStamped()
        message.twist.linear.x, message.twist.angular.z = v, w
        self.commands.publish(message)

    async def execute(self, handle):
        done = Future()
        self.job = {"handle": handle, "done": done, "path": None, "asked": False, "since": None, "turning": False}
        word = await done
        self.job = None
        self.command(0.0, 0.0)
        {"there": handle.succeed, "stop": handle.canceled, "stuck": handle.abort}[word]()
        return NavigateToPose.Result()

    def planned(self, future):
        if self.job:
            self.job["path"] = [(p.pose.position.x, p.pose.position.y) for p in future.result().plan.poses]

    def step(self):
        job = self.job
        if not job or job["done"].done():
            return
        if job["handle"].is_cancel_requested:
            return job["done"].set_result("stop")
        try:
            t = self.buffer.lookup_transform("map", "base_link", Time()).transform
        except TransformException:
            return
        x, y, h = t.translation.x, t.translation.y, 2 * math.atan2(t.rotation.z, t.rotation.w)
        goal = job["handle"].request.pose.pose
        if not job["asked"]:
            job["asked"] = True
            request = GetPlan.Request(goal=job["handle"].request.pose)
            request.start.header.frame_id = "map"
            request.start.pose.position.x, request.start.pose.position.y = x, y
            self.plans.call_async(request).add_done_callback(self.planned)
        if job["path"] is None:
            return
        if not job["path"]:
            return job["done"].set_result("stuck")
        while len(job["path"]) > 1 and math.dist((x, y), job["path"][0]) < 0.2:
            job["path"].pop(0)
        left = math.dist((x, y), (goal.position.x, goal.position.y))
        job["handle"].publish_feedback(NavigateToPose.Feedback(distance_remaining=left))
        px, py = job["path"][0]
        off = math.remainder(math.atan2(py - y, px - x) - h, math.tau)
        job["turning"] = job["turning"] or left < 0.05
        if job["turning"]:
            off = math.remainder(2 * math.atan2(goal.orientation.z, goal.orientation.w) - h, math.tau)
            if abs(off) < 0.06:
                return job["done"].set_result("there")
        v = 0.0 if job["turning"] or abs(off) > 0.6 or self.near < 0.25 else min(0.15, 0.05 + 0.5 * left)
        now = self.get_clock().now().nanoseconds * 1e-9
        if v or abs(off) > 0.6 or job["turning"]:
            job["since"] = now
        elif now - (job["since"] or now) > 3.0:
            return job["done"].set_result("stuck")
        job["since"] = job["since"] or now
        self.command(v, max(-1.5, min(1.5, 2.5 * off)))
"""

ANSWERS = Answers(
    "robot-8",
    5,
    DRIVE_THERE,
    [
        Wrong("rejects_cancel", changed(DRIVE_THERE, ("ACCEPT", "REJECT")), 4, "a cancel_callback that accepts"),
        Wrong(
            "ignores_cancel",
            changed(DRIVE_THERE, ("if handle.is_cancel_requested:", "if False:")),
            4,
            "in each tick",
        ),
        Wrong(
            "drives_on",
            changed(DRIVE_THERE, (CANCELED, "                handle.canceled()")),
            4,
            "until its watchdog stops it",
        ),
        Wrong(
            "at_once",
            changed(DRIVE_THERE, ("            if self.follow(path, place, handle):", "            if True:")),
            0,
            "succeed when tf says",
        ),
        Wrong(
            "odometry_for_truth",
            changed(DRIVE_THERE, ('lookup_transform("map"', 'lookup_transform("odom"')),
            0,
            "look `base_link` up in `map`",
        ),
        Wrong("degrees", changed(DRIVE_THERE, ("wrapped(goal[2]", "wrapped(math.degrees(goal[2])")), 4, "in radians"),
        Wrong(
            "heading_sign",
            changed(DRIVE_THERE, ("wrapped(goal[2] - place[2])", "wrapped(place[2] - goal[2])")),
            3,
            "Left is positive",
        ),
        Wrong("no_heading", changed(DRIVE_THERE, ("return abs(turn) < 0.08", "return True")), 4, "2 atan2(z, w)"),
        Wrong(
            "blind",
            changed(DRIVE_THERE, ("max(0.0, 0.8 * (self.room - 0.05))", "0.2")),
            4,
            "has bumped into it",
        ),
        Wrong(
            "turns_for_ever",
            changed(DRIVE_THERE, ("abs(math.atan2(y, x)) > 0.7", "abs(math.atan2(x, y)) > 0.7")),
            1,
            "atan2(y, x)",
        ),
        Wrong(
            "feedback_grows",
            changed(DRIVE_THERE, ("distance_remaining=float(left)", "distance_remaining=float(nearest * 0.05)")),
            4,
            "not what is done",
        ),
        Wrong(
            "sleeps",
            changed(
                DRIVE_THERE,
                (
                    "            await self.ticked\n            place, now",
                    "            sleep(0.1)\n            place, now",
                ),
                ("import math\n", "import math\nfrom time import sleep\n"),
            ),
            0,
            "without an end",
        ),
        Wrong("never_gives_up", changed(DRIVE_THERE, ("> 8e9", "> 8e99")), 4, "When it has not come on"),
    ],
    {"in_threads": IN_THREADS, "by_timer": BY_TIMER},
    together=8,
)
