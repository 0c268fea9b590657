"""The room of robot-8: a robot, tf, a planner that does not know all, and how a journey went."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from nav_msgs.srv import GetPlan
from rcl_interfaces.srv import GetParameters
from rclpy.node import Node
from tf2_ros import TransformBroadcaster

from course_kit.exercises.checker.action_assertions import Client, Goal
from course_kit.exercises.checker.assertions import chance, wait
from course_kit.exercises.checker.examination import current
from course_kit.exercises.checker.robot_fixtures import a_robot, a_way
from course_kit.exercises.checker.service_assertions import Client as ServiceClient
from course_kit.exercises.checker.service_assertions import a_server
from course_kit.robots.navigation.messages import path_message, place_of, stamped_pose, transform_of
from course_kit.robots.navigation.places import Floats, Place, after, inverse, wrapped
from course_kit.robots.robot.world import Pillar
from course_kit.robots.robot.worlds import world

FACTOR, SLOWEST = 3.0, 0.5  # simulated seconds a second: on a machine that is free, and at least
BEHIND = 0.1  # simulated seconds that the answer's node may be behind
ANSWER_TIMEOUT = 1.0  # seconds
LATE = 15.0  # seconds of real time that there are for a late command
PERIOD = 0.05  # seconds of real time from one map → odom to the next
AHEAD = 1.0  # simulated seconds for which it counts, so that none is missing on a busy machine
LAST_STEPS = 7  # points of a path, some 0.3 m, by which to know where a robot looks at its end
APART = 1.2  # rad
BEYOND = 0.9  # metres from the middle of the pillar to a goal behind it


@dataclass
class Journey:
    """A goal, and how the robot moved until it ended; metres, radians, simulated seconds."""

    goal: Place
    start: Place
    sent: Goal
    began: float
    way: float = 0.0  # of the plan, or as the crow flies
    seconds: float = 0.0
    place: Place = (0.0, 0.0, 0.0)  # at its end, by tf
    away_in_odom: float = math.inf
    bumps: int = 0
    # When (nanoseconds since the epoch), and what was left then: along the plan, and as the crow flies.
    left: list[tuple[int, float, float]] = field(default_factory=list)

    @property
    def away(self) -> float:
        """Metres from the goal at its end."""
        return math.dist(self.place[:2], self.goal[:2])

    @property
    def wrong_feedback(self) -> float:
        """By how many metres the feedback was wrong at the median, whichever way it counts."""
        if not self.sent.told or not self.left:
            return math.inf
        times, *ways = (np.array(column, np.float64) for column in zip(*self.left, strict=True))
        told = [(when, said.distance_remaining) for when, said in self.sent.told]
        off = [min(abs(float(np.interp(when, times, way)) - said) for way in ways) for when, said in told]
        return float(np.median(off))


class Room:
    """A robot among two pillars, of which /get_plan knows one; tf tells where it is, and odometry drifts."""

    def __init__(self) -> None:
        mirrored, turned = chance().random() < 0.5, chance().random() < 0.5

        def at(x: float, y: float) -> tuple[float, float]:
            return (6.0 - x if turned else x), (5.0 - y if mirrored else y)

        drawn = chance().uniform
        pillar = Pillar(*at(drawn(2.0, 2.2), drawn(0.95, 1.15)), drawn(0.12, 0.18))
        start, goal = at(drawn(0.9, 1.1), 1.0), at(drawn(3.1, 3.4), drawn(0.9, 1.2))
        known = replace(world("empty"), pillars=(pillar,))
        before, last = a_way(known, start, goal)[-LAST_STEPS :: LAST_STEPS - 1]
        self.goal: Place = (*goal, _heading(math.atan2(last[1] - before[1], last[0] - before[0])))
        self._known = replace(known, start=(*start, _heading(self.goal[2])))
        self._unknown = Pillar(*at(drawn(4.0, 4.4), drawn(2.5, 2.8)), drawn(0.15, 0.25))
        self.far: Place = (*at(5.1, drawn(0.8, 1.2)), _heading())
        self.robot = a_robot(replace(self._known, pillars=(pillar, self._unknown)), factor=FACTOR, patience=LATE)
        self.asked, self.start_error = 0, 0.0  # metres between where a path was asked from, and the robot
        self._plan: Floats | None = None
        self._node: ServiceClient | None = None
        a_server("/get_plan", GetPlan, self._answer)
        current().test_domain.on_own_node(self._localize)

    def _localize(self, node: Node) -> None:
        """Have a node tell where odom lies in the map, as somebody would who is always right."""
        broadcaster = TransformBroadcaster(node)
        robot = self.robot

        def tell() -> None:
            with robot.simulation.still:
                odom = after(self.place(), inverse(robot.vehicle.odometry.place))
                stamp = self._now(AHEAD)
            broadcaster.sendTransform(transform_of(odom, "map", "odom", stamp))

        node.create_timer(PERIOD, tell)

    def place(self) -> Place:
        """Where the robot is in the map: in truth, and as tf tells."""
        return self.robot.simulation.true_place(self.robot.vehicle.number)

    def behind_the_pillar(self) -> Place:
        """A goal to which the straight way leads through the unknown pillar."""
        x, y, _ = self.place()
        part = 1 + BEYOND / math.dist((x, y), (self._unknown.x, self._unknown.y))
        return x + part * (self._unknown.x - x), y + part * (self._unknown.y - y), _heading()

    def to_the_pillar(self) -> float:
        """Metres from the robot's middle to the unknown pillar."""
        return math.dist(self.place()[:2], (self._unknown.x, self._unknown.y)) - self._unknown.radius

    def _answer(self, request: Any, response: Any) -> Any:
        start, goal = place_of(request.start.pose), place_of(request.goal.pose)
        self.asked += 1
        self.start_error = max(self.start_error, math.dist(start[:2], self.place()[:2]))
        try:
            self._plan = np.array(a_way(self._known, start[:2], goal[:2]))
        except ValueError:  # of a start or a goal that is in no room
            return response
        response.plan = path_message(self._plan, goal[2], "map", self._now())
        return response

    def _now(self, ahead: float = 0.0) -> Time:
        seconds, nanoseconds = divmod(self.robot.simulation.nanoseconds + round(ahead * 1e9), 1_000_000_000)
        return Time(sec=seconds, nanosec=nanoseconds)

    def keep_pace(self) -> None:
        """Let time go as fast as the answer's node can follow, by how long that takes to answer what all nodes do.

        On a busy machine it would else see itself where it was a while ago, and drive by that.
        """
        if self._node is None:
            self._node = ServiceClient("/drive_there/get_parameters", GetParameters)
        answers = [self._node.ask(ANSWER_TIMEOUT, names=["use_sim_time"]) for _ in range(3)]
        seconds = sorted(one.seconds for one in answers)[1]
        self.robot.simulation.go_at(min(FACTOR, max(SLOWEST, BEHIND / max(seconds, 1e-3))))

    def send(self, client: Client, goal: Place) -> Journey:
        """Send a goal."""
        self.keep_pace()
        self._plan = None
        start, began = self.place(), self.robot.simulation.time
        sent = client.send(pose=stamped_pose(goal, "map", self._now()))
        return Journey(goal, start, sent, began, math.dist(start[:2], goal[:2]))

    def follow(
        self, journey: Journey, seconds: float, timeout: float, until: Callable[[], bool] = lambda: False
    ) -> None:
        """Note how the robot moves until the goal has ended, so many simulated seconds are over, or `until` holds."""
        simulation, bumps = self.robot.simulation, self.robot.vehicle.bumps

        def is_over() -> bool:
            self._note(journey)
            has_ended = journey.sent.status is not None or not journey.sent.accepted
            return has_ended or simulation.time > journey.began + seconds or until()

        wait(is_over, timeout, "the goal to end", poll=0.02)
        journey.seconds = simulation.time - journey.began
        journey.bumps = self.robot.vehicle.bumps - bumps
        self.look(journey)

    def look(self, journey: Journey) -> None:
        """Note where the robot is now."""
        journey.place = self.place()
        journey.away_in_odom = math.dist(self.robot.vehicle.odometry.place[:2], journey.goal[:2])

    def _note(self, journey: Journey) -> None:
        place, plan = self.place(), self._plan
        direct = along = math.dist(place[:2], journey.goal[:2])
        if plan is not None:
            steps = np.hypot(*np.diff(plan, axis=0).T)
            nearest = int(np.hypot(*(plan - np.array(place[:2])).T).argmin())
            along = float(steps[nearest:].sum())
            journey.way = float(steps.sum())
        journey.left.append((time.time_ns(), along, direct))


def _heading(*others: float) -> float:
    """One that no mistake makes look right: far from `others`, from no turn, and from its degrees taken for radians."""
    while True:
        heading = chance().uniform(-math.pi, math.pi)
        if all(abs(wrapped(other - heading)) > APART for other in (0.0, math.degrees(heading), *others)):
            return heading
