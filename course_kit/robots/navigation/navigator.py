"""The node navigator: the action navigate_to_pose, as Nav2 has it."""

from __future__ import annotations

import math
import time
from typing import Any

import numpy as np
from geometry_msgs.msg import PoseStamped, TwistStamped
from nav2_msgs.action import NavigateToPose
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetPlan
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.task import Future
from rclpy.time import Time
from sensor_msgs.msg import LaserScan

from course_kit.robots.navigation.frames import Frames, PlacedScans
from course_kit.robots.navigation.journey import Journey
from course_kit.robots.navigation.messages import LATCHED, map_of, place_of, points_of, rays_of, stamped_pose
from course_kit.robots.navigation.places import Floats, Place, hits, moved
from course_kit.robots.navigation.planning import NO_VALID_PATH, CostMap, PlanError, refuse
from course_kit.robots.navigation.pursuit import Limits

TF_ERROR, TIMEOUT = 9002, 207  # Nav2's codes: nobody tells where the robot is; the planner does not answer
PERIOD = 0.1  # seconds from command to command
RETRY = 0.02  # seconds of real time
# By an older place or scan it does not drive on; without newer ones for so long it stops.
PLACE_AGE, SCAN_AGE, STOP = Duration(seconds=0.2), Duration(seconds=0.6), Duration(seconds=0.5)
REST_AGE = Duration(seconds=2.0)  # what counts while it stands
ANSWER = 10.0  # seconds of real time for the planner's answer, and for tf and the laser to tell of the robot
LOST = 3.0  # seconds of real time after which the planner is asked again: its answer may be lost on the way
REFUSALS = 5  # in a row, once the robot is on its way: what stands before it may go away


class Navigator(Node):
    """Drives to goals of the action navigate_to_pose, and to those on /goal_pose, by the service get_plan.

    A new goal takes the place of the one that runs. Parameters: `speed` (m/s), `turning` (rad/s), `robot_radius`,
    `margin`, `lookahead` (m), `map_frame`, `base_frame`. Takes Node's keyword arguments.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__("navigator", **options)
        self.frames = Frames(self, self.on_restart)
        defaults = {"speed": 0.2, "turning": 1.2, "robot_radius": 0.105, "lookahead": 0.25, "margin": 0.03}
        *limits, self.margin = (self.declare_parameter(*one).value for one in defaults.items())
        self.limits = Limits(*limits)
        self.journey: Journey | None = None
        self.answers: list[Future] = []  # of the planner, while it is asked; the first that comes counts
        self.asked = 0.0  # when it was last, by time.monotonic()
        self.content = 0.0  # when all that is needed was there, by time.monotonic()
        self.refusals = 0
        self.cost_map: CostMap | None = None
        self.hits: Floats = np.zeros((0, 2))  # of the last scan, seen from the robot
        self.seen: Time | None = None  # when that was
        self.driven: Time | None = None  # when a command was sent
        self.rests = True  # by the last command
        self.waits = False  # for a newer place or scan
        self.ticked = Future()
        self.publisher = self.create_publisher(TwistStamped, "cmd_vel", 10)
        self.create_subscription(OccupancyGrid, "map", self.on_map, LATCHED)
        self.create_subscription(PoseStamped, "goal_pose", self.on_goal_pose, 1)
        self.scans = PlacedScans(self, self.frames, self.frames.base, self.on_scan)
        self.planner = self.create_client(GetPlan, "get_plan")
        choices = {"goal_callback": self.on_goal, "cancel_callback": lambda _: CancelResponse.ACCEPT}
        group = ReentrantCallbackGroup()  # a goal that runs leaves room for the next
        name = "navigate_to_pose"
        self.server = ActionServer(self, NavigateToPose, name, self.execute, callback_group=group, **choices)
        self.client = ActionClient(self, NavigateToPose, name)
        self.create_timer(PERIOD, self.on_tick)
        # A simulation may stand still until the robot has its command: then no timer of its time fires.
        self.create_timer(RETRY, self.on_retry, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def on_tick(self) -> None:
        """Have the goals go on that wait for the next tick."""
        ticked, self.ticked = self.ticked, Future()
        ticked.set_result(None)

    def on_retry(self) -> None:
        """Look again whether what was missing has come."""
        if self.waits:
            self.on_tick()

    def on_restart(self) -> None:
        """The simulation has begun anew: a goal that runs is over."""
        self.cost_map = self.seen = self.driven = None
        if self.journey is not None:
            self.journey.fail(TF_ERROR, "time has jumped back: the simulation has begun anew")

    def on_map(self, message: OccupancyGrid) -> None:
        """Look whether the path is still free on this map."""
        try:
            self.cost_map = CostMap(map_of(message), self.limits.radius + self.margin, into_unknown=True)
        except ValueError as error:
            self.get_logger().error(f"Cannot use /map: {error}")
            return
        place = self.place()
        if self.journey is not None and place is not None:
            self.journey.check(self.cost_map, place)

    def on_scan(self, scan: LaserScan, laser: Place) -> None:
        """Remember what stands around the robot."""
        self.hits, self.seen = moved(hits(*rays_of(scan)), laser), Time.from_msg(scan.header.stamp)

    def on_goal_pose(self, pose: PoseStamped) -> None:
        """Send the action a goal: that is what rviz2's arrow does with Nav2."""
        self.client.send_goal_async(NavigateToPose.Goal(pose=pose))

    def on_goal(self, goal: NavigateToPose.Goal) -> GoalResponse:
        """Accept what is a place at all."""
        return GoalResponse.ACCEPT if all(map(math.isfinite, place_of(goal.pose.pose))) else GoalResponse.REJECT

    async def execute(self, handle: ServerGoalHandle) -> NavigateToPose.Result:
        """Drive to a goal; ends when it is reached, cancelled, or cannot be reached."""
        if self.journey is not None:
            self.journey.fail(0, "another goal has taken its place")
        try:
            goal = self.frames.in_map(handle.request.pose)
        except ValueError as error:
            handle.abort()
            return NavigateToPose.Result(error_code=TF_ERROR, error_msg=str(error))
        journey = self.journey = Journey(goal, self.limits)
        self.answers, self.refusals, self.content = [], 0, time.monotonic()
        began = self.get_clock().now()
        while journey.end is None and handle.is_active and not handle.is_cancel_requested:
            await self.ticked
            if self.journey is journey:
                self.go_on(journey, handle, began)
        if self.journey is journey:
            self.journey, self.waits = None, False
            self.drive(0.0, 0.0)
        return self.result_of(journey, handle)

    def result_of(self, journey: Journey, handle: ServerGoalHandle) -> NavigateToPose.Result:
        """End a goal as its journey has ended."""
        end = journey.end
        if end is None and handle.is_cancel_requested:
            handle.canceled()
        elif end is not None and end.arrived:
            handle.succeed()
        elif end is not None and handle.is_active:
            self.get_logger().warning(f"Gave up: {end.why}")
            handle.abort()
            return NavigateToPose.Result(error_code=end.code, error_msg=end.why)
        return NavigateToPose.Result()

    def go_on(self, journey: Journey, handle: ServerGoalHandle, began: Time) -> None:
        """What there is to do in a tick: ask for a path, drive, tell how far it is."""
        place, now = self.place(), self.get_clock().now()
        self.waits = place is None or self.seen is None or now - self.seen > (REST_AGE if self.rests else SCAN_AGE)
        if place is None or self.waits:
            if self.driven is None or now - self.driven > STOP:
                self.drive(0.0, 0.0)
            if time.monotonic() - self.content > ANSWER:
                missing = "tf has told where the robot is on the map" if place is None else "a scan has come"
                why = "have all nodes the same use_sim_time, and does a mapper or a localizer run?"
                journey.fail(TF_ERROR, f"for {ANSWER:g} s nothing of {missing}: {why}")
            return
        self.take_answer(journey, place)
        self.ask(journey, place)
        self.drive(*journey.tick(now.nanoseconds * 1e-9, place, self.hits))
        feedback = NavigateToPose.Feedback(distance_remaining=journey.remaining(place))
        feedback.current_pose = stamped_pose(place, self.frames.map, now.to_msg())
        feedback.navigation_time = (now - began).to_msg()
        feedback.estimated_time_remaining = Duration(seconds=journey.remaining(place) / self.limits.speed).to_msg()
        feedback.number_of_recoveries = max(0, journey.paths - 1)
        handle.publish_feedback(feedback)

    def ask(self, journey: Journey, place: Place) -> None:
        """Ask the planner for a path when one is wanted; it answers later."""
        if not self.answers and self.planner.service_is_ready() and journey.wants_path(self.seconds()):
            self.send(journey, place)

    def send(self, journey: Journey, place: Place) -> None:
        """Send the planner a request; one that it has not answered yet stays, for it may be slow."""
        now = self.get_clock().now().to_msg()
        start, goal = (stamped_pose(one, self.frames.map, now) for one in (place, journey.goal))
        self.answers.append(self.planner.call_async(GetPlan.Request(start=start, goal=goal)))
        self.asked = time.monotonic()

    def take_answer(self, journey: Journey, place: Place) -> None:
        """Follow the path that has come, or see why there is none."""
        answer = next((one for one in self.answers if one.done()), None)
        if answer is None:
            if journey.paths and not self.answers:
                self.content = time.monotonic()
            elif time.monotonic() - self.content > ANSWER:
                journey.fail(TIMEOUT, f"no path came within {ANSWER:g} s: does a planner with a map offer get_plan?")
            elif self.answers and time.monotonic() - self.asked > LOST:
                self.send(journey, place)
            return
        for other in self.answers:
            self.planner.remove_pending_request(other)
        points, self.answers, self.content = points_of(answer.result().plan), [], time.monotonic()
        self.refusals = 0 if len(points) > 1 else self.refusals + 1
        if not self.refusals:
            journey.follow(points)
        elif not journey.paths or self.refusals >= REFUSALS:
            journey.fail(*self.reason(place, journey.goal))
        else:
            journey.refuse()

    def reason(self, place: Place, goal: Place) -> tuple[int, str]:
        """Why there is no path, as far as the map tells: Nav2's code, and one sentence."""
        try:
            if self.cost_map is not None:
                refuse(self.cost_map.reaching(np.array([place[:2], goal[:2]])), place[:2], goal[:2])
        except PlanError as refused:
            return refused.code, str(refused)
        return NO_VALID_PATH, "the planner knows no path to the goal; its log says why"

    def place(self) -> Place | None:
        """Where the robot is on the map; None if nobody has told of late."""
        return self.frames.place(self.frames.map, self.frames.base, oldest=REST_AGE if self.rests else PLACE_AGE)

    def seconds(self) -> float:
        """The time."""
        return self.get_clock().now().nanoseconds * 1e-9

    def drive(self, speed: float, turning: float) -> None:
        """Send a command, m/s and rad/s."""
        self.driven, self.rests = self.get_clock().now(), not (speed or turning)
        command = TwistStamped()
        command.header.stamp, command.header.frame_id = self.driven.to_msg(), self.frames.base
        command.twist.linear.x, command.twist.angular.z = speed, turning
        self.publisher.publish(command)
