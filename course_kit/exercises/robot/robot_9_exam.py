"""The check of robot-9, the exam: a launch that finds its way in worlds that are drawn for each check."""

from __future__ import annotations

import contextlib
import math
from dataclasses import dataclass, field

import numpy as np
import psutil  # type: ignore[import-untyped]
from geometry_msgs.msg import PoseStamped
from nav2_msgs.action import NavigateToPose
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetPlan
from rclpy.time import Time

from course_kit.base.programs.child_process import Process
from course_kit.base.programs.process_ids import own_ids
from course_kit.exercises.checker.action_assertions import Client, expect_action
from course_kit.exercises.checker.assertions import chance, expect, require, wait
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.examination import current
from course_kit.exercises.checker.robot_fixtures import a_robot, hear_tf, place_in
from course_kit.exercises.checker.service_assertions import Client as ServiceClient
from course_kit.exercises.checker.workspace_assertions import (
    expect_installed,
    expect_package,
    get_parameters,
    said,
    start,
    started,
)
from course_kit.exercises.checker.workspace_terminal import folder
from course_kit.exercises.robot.exam_worlds import Task, draw
from course_kit.robots.navigation.grid_map import OCCUPIED, GridMap
from course_kit.robots.navigation.messages import map_of, place_of, stamped_pose
from course_kit.robots.navigation.places import Place, between, moved
from course_kit.robots.robot.world import World
from course_kit.ros.observing.received_messages import ReceivedMessages
from course_kit.ros.private_api.fastdds_parts import Origin
from course_kit.ros.private_api.rmw_parts import service_topics

KINDS = ("rooms", "maze", "office")
FACTOR, LATE = 6.0, 15.0  # simulated seconds a second; real ones that there are for a late command
NEAR = 0.25  # metres, of the text
SPEED, TIMES, BESIDES = 0.2, 4.0, 30.0  # m/s, and how much longer it may take, of the text; simulated seconds
BEGIN_TIMEOUT, REAL_TIMEOUT = 45.0, 90.0  # seconds until a launch offers the action, and for a journey
ELSEWHERE = 0.3  # metres from the map's origin
TF_TIMEOUT = 8.0  # seconds until what a launch has started tells where the robot is
MAP_TIMEOUT = 3.0  # seconds until a map comes
TRUE_WALLS, BESIDE = 0.7, 0.15  # of the walls of a map that is of this world, so many are so near to true ones, m
BESIDE_GOAL = 0.4  # metres from the goal to the end of a path that does not lead there
JUDGED = ("/map", "/cmd_vel")


@dataclass
class Crossing:
    """How it went in one world; metres, simulated seconds."""

    task: Task
    word: str  # what became of the goal
    away: float
    seconds: float
    bumps: int
    own: bool  # whether a program of the student's was in it
    begins: Place | None  # where tf says that the robot begins
    reason: str = ""  # what the result says of why it has ended
    # If it is not reached: nodes without simulated time, the share of the map's walls that are true, where a path ends.
    by_own_clock: list[str] = field(default_factory=list)
    true_walls: float = 1.0
    path_end: tuple[float, float] = (0.0, 0.0)
    beside_goal: float = 0.0  # how far that is from the goal

    @property
    def is_reached(self) -> bool:
        """True if it is where it was sent to, and the goal succeeded."""
        return self.word == "succeeded" and self.away < NEAR

    @property
    def allowed(self) -> float:
        """The seconds that it may take."""
        return TIMES * self.task.way / SPEED + BESIDES

    def __str__(self) -> str:
        return f"{self.task.world.name}, seed {self.task.world.seed}"


@check_of("robot-9")
def rooms_never_seen() -> None:
    """The launch takes the robot through three worlds that nobody has seen."""
    expect_package("explorer", "ament_python")
    expect_installed("explorer", "launch/explorer.launch.py")
    kinds = chance().sample(KINDS, len(KINDS))
    crossings = [_cross(task) for task in [draw(kind, chance()) for kind in kinds]]
    for kind in KINDS:
        one = next(crossing for crossing in crossings if crossing.task.world.name == kind)
        expect(f"it crosses a world of the kind `{kind}`", one.is_reached, _why_not(one))
    reached = [one for one in crossings if one.is_reached]
    slow = [one for one in crossings if one.seconds > one.allowed]
    told = ", ".join(f"{one}: {one.seconds:.0f} s where {one.allowed:.0f} are allowed" for one in slow)
    expect(
        "it takes no longer than it may",
        reached and not slow,
        f"{told or 'It has crossed none'}. Robots that wait: for a path, or for a map; or drive ways that are no way.",
    )
    bumped = [one for one in reached if one.bumps]
    told = ", ".join(f"{one}: {one.bumps} times" for one in bumped)
    expect(
        "it touches nothing",
        reached and not bumped,
        f"It bumped ({told}): the scan has the last word before the wheels." if told else "It has crossed none.",
    )
    expect(
        "a program of yours takes part",
        any(one.own for one in crossings),
        "What publishes /map and /cmd_vel and serves /get_plan are the given programs: start one of a package of "
        "yours in the place of one of them, with Node(package='explorer', executable=…).",
    )


def _cross(task: Task) -> Crossing:
    """Start the launch beside a robot in a world that it does not know, and send it a goal."""
    robot = a_robot(task.world, factor=FACTOR, patience=LATE)
    launch = start("ros2", "launch", "explorer", "explorer.launch.py", "use_sim_time:=true")
    client = _client(launch)
    told = hear_tf()
    wait(lambda: told.has("map", "base_link"), TF_TIMEOUT, "map → base_link on tf", poll=0.2)
    begins = place_in(told.buffer(), "map", "base_link")
    simulation, number = robot.simulation, robot.vehicle.number
    began = simulation.time
    heading = chance().uniform(-math.pi, math.pi)
    seen = between(task.world.start, (*task.goal, heading))
    goal = stamped_pose(seen, "map", Time(nanoseconds=simulation.nanoseconds).to_msg())
    sent = client.send(pose=goal)
    crossing = Crossing(task, "", 0.0, 0.0, 0, _has_own(), begins)
    wait(
        lambda: not sent.accepted or sent.status is not None or simulation.time - began > crossing.allowed,
        REAL_TIMEOUT,
        f"the end of the journey in {crossing}",
        poll=0.05,
    )
    crossing.word, crossing.seconds = sent.word, simulation.time - began
    crossing.reason = _said_by(sent.result)
    crossing.own = crossing.own or _has_own()
    crossing.away = math.dist(simulation.true_place(number)[:2], task.goal)
    crossing.bumps = robot.vehicle.bumps
    if not crossing.is_reached:
        _look_why(crossing, goal)
    launch.stop(5.0)
    current().test_domain.tidy()
    return crossing


def _look_why(crossing: Crossing, goal: PoseStamped) -> None:
    """See what its nodes go by, what their map is worth, and where their paths lead."""
    test_domain = current().test_domain
    nodes = test_domain.their_nodes()
    crossing.by_own_clock = [node for node in nodes if get_parameters(node, "use_sim_time") == [False]]
    maps = ReceivedMessages(OccupancyGrid, "/map", test_domain.counts)
    test_domain.hear(maps, kept=True)
    if wait(lambda: len(maps), MAP_TIMEOUT, "a map on /map"):
        with contextlib.suppress(ValueError):
            crossing.true_walls = _true_walls(map_of(maps.last), crossing.task.world)
    if any("/get_plan" in node.service_servers for node in test_domain.offered()):
        start = stamped_pose(crossing.begins or (0.0, 0.0, 0.0), "map", goal.header.stamp)
        answer = ServiceClient("/get_plan", GetPlan).ask(start=start, goal=goal).response
        if answer is not None and answer.plan.poses:
            crossing.path_end = x, y = place_of(answer.plan.poses[-1].pose)[:2]
            crossing.beside_goal = math.dist((x, y), place_of(goal.pose)[:2])


def _true_walls(found: GridMap, where: World) -> float:
    """The share of a map's walls that are walls of the world, with the robot's start as its origin."""
    walls = found.centres(*np.nonzero(found.cells >= OCCUPIED))
    if not len(walls):
        return 1.0
    return float((np.abs(where.clearances(*moved(walls, where.start).T)) < BESIDE).mean())


def _client(launch: Process) -> Client:
    """A client of the launch's action, once that is there."""
    observer = current().test_domain

    def is_offered() -> bool:
        observer.examine_processes(started())
        actions = {name for node in observer.offered() for name in node.action_servers}
        return "/navigate_to_pose" in actions or not launch.is_running

    wait(is_offered, BEGIN_TIMEOUT, "the action /navigate_to_pose of the launch", poll=0.2)
    hint = f"{said(launch, 4)}`ros2 launch explorer explorer.launch.py` says why."
    require("the launch runs", launch.is_running, hint)
    return expect_action("/navigate_to_pose", NavigateToPose)


def _said_by(result: NavigateToPose.Result | None) -> str:
    """The first line of what a result says of its error, if it says anything."""
    return "" if result is None else result.error_msg.strip().partition("\n")[0][:200].rstrip(".")


def _has_own() -> bool:
    """Return True if a program of the workspace publishes the judged topics or serves /get_plan."""
    node = current().test_domain.node
    names = [*(f"rt{topic}" for topic in JUDGED), *service_topics("/get_plan")]
    ids = [bytes(end.endpoint_gid) for name in names for end in node.get_publishers_info_by_topic(name, no_mangle=True)]
    origins = {origin.pid_bits for one in ids if (origin := Origin.of(one)) is not None}
    return any(origins & {pid & 0xFFFF for pid in own_ids([program])} for program in _own_programs())


def _own_programs() -> list[int]:
    """The processes that were started for the check and run a program of the workspace."""
    install, found = str(folder() / "install"), []
    for pid in started():
        with contextlib.suppress(psutil.Error):  # it has ended
            if any(word.startswith(install) for word in psutil.Process(pid).cmdline()[:3]):
                found.append(pid)
    return found


def _why_not(one: Crossing) -> str:
    hint = f"In {one} the goal, {one.task.way:.1f} m of way from the start, is {one.word} after {one.seconds:.0f} s"
    hint += f", and the robot {one.away:.2f} m from it"
    hint += f", with {one.bumps} bumps. " if one.bumps else ". "
    hint += f"Its result says: {one.reason}. " if one.reason else ""
    if one.word == "rejected":
        return f"{hint}Accept goals in `map`, however far: nobody knows the map before."
    if one.by_own_clock:
        return f"{hint}{', '.join(one.by_own_clock)} goes by the machine's clock: hand `use_sim_time` on to every node."
    if one.begins is not None and math.hypot(*one.begins[:2]) > ELSEWHERE:
        x, y, _ = one.begins
        return f"{hint}By tf the robot begins at ({x:.1f}, {y:.1f}) of `map`, and not at (0, 0): no `initial_pose`."
    if one.true_walls < TRUE_WALLS:
        return (
            f"{hint}Of the walls on /map {100 * one.true_walls:.0f} % are walls here: it is the map of other rooms, or "
            "scans are put into it from wrong places. Nobody has the map of these rooms; it is made from /scan."
        )
    if one.begins is None:
        return f"{hint}tf does not tell where base_link is in `map`: that is for who makes the map."
    if one.beside_goal > BESIDE_GOAL:
        x, y = one.path_end
        return (
            f"{hint}The path of /get_plan ends at ({x:.1f}, {y:.1f}), {one.beside_goal:.1f} m from the goal: plan to "
            "the `goal` of the request, on the map that has come last. A way by heart is one through other rooms."
        )
    if one.word == "succeeded":
        return f"{hint}Succeed when tf says that base_link is where the goal is in `map`, and not before."
    return (
        f"{hint}The first path leads through walls that nobody has seen yet: ask for another one when the map grows, "
        f"and when something stands in the way. See it: `run(Robot, world={one.task.world.name!r}, "
        f"seed={one.task.world.seed}, factor=4.0)`, your launch, and `show_robot`."
    )
