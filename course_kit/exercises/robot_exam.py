"""Chapter 7's exam: a launch that finds its way in worlds drawn for each check, and how that is judged."""

from __future__ import annotations

import contextlib
import math
from dataclasses import dataclass, field
from itertools import pairwise

import psutil  # type: ignore[import-untyped]
from nav2_msgs.action import NavigateToPose
from rclpy.time import Time

from course_kit.examining.examination import current
from course_kit.examining.exercise import exercise
from course_kit.examining.vocabulary import chance, expect, require, wait
from course_kit.examining.vocabulary_actions import Client, expect_action
from course_kit.examining.vocabulary_robot import a_robot, a_way, hear_tf, place_in
from course_kit.examining.vocabulary_workspace import (
    expect_installed,
    expect_package,
    get_parameters,
    said,
    start,
    started,
)
from course_kit.examining.workspace_terminal import folder
from course_kit.internals.fastdds_parts import Origin
from course_kit.internals.rmw_parts import service_topics
from course_kit.navigation.messages import stamped_pose
from course_kit.navigation.places import Place, between
from course_kit.programs.child_process import Process
from course_kit.programs.process_ids import own_ids
from course_kit.robot.world import World
from course_kit.robot.worlds import world

KINDS = ("rooms", "maze", "office")
FACTOR, LATE = 6.0, 15.0  # simulated seconds a second; real ones that there are for a late command
SHORTEST, LONGEST = 2.0, 6.0  # metres of way to a goal
NEAR = 0.25  # metres, of the text
SPEED, TIMES, BESIDES = 0.2, 4.0, 30.0  # m/s, and how much longer it may take, of the text; simulated seconds
BEGIN_TIMEOUT, REAL_TIMEOUT = 45.0, 60.0  # seconds until a launch offers the action, and for a journey
ELSEWHERE = 0.3  # metres from the map's origin
TF_TIMEOUT = 8.0  # seconds until what a launch has started tells where the robot is
JUDGED = ("/map", "/cmd_vel")


@dataclass
class Crossing:
    """How it went in one world; metres, simulated seconds."""

    kind: str
    seed: int
    way: float
    word: str  # what became of the goal
    away: float
    seconds: float
    bumps: int
    own: bool  # whether a program of the student's was in it
    begins: Place | None  # where tf says that the robot begins
    by_own_clock: list[str] = field(default_factory=list)  # nodes without simulated time, if it is not reached

    @property
    def is_reached(self) -> bool:
        """Whether it is where it was sent to, and the goal succeeded."""
        return self.word == "succeeded" and self.away < NEAR

    @property
    def allowed(self) -> float:
        """The seconds that it may take."""
        return TIMES * self.way / SPEED + BESIDES

    def __str__(self) -> str:
        return f"{self.kind}, seed {self.seed}"


@exercise(
    "robot-9",
    "Rooms never seen",
    points=6,
    level="project",
    timeout=170,
    file="explorer/launch/explorer.launch.py",
)
def rooms_never_seen() -> None:
    """The launch takes the robot through three worlds that nobody has seen."""
    expect_package("explorer", "ament_python")
    expect_installed("explorer", "launch/explorer.launch.py")
    kinds = chance().sample(KINDS, len(KINDS))
    crossings = [_cross(kind) for kind in kinds]
    for kind in KINDS:
        one = next(crossing for crossing in crossings if crossing.kind == kind)
        expect(f"it crosses a world of the kind `{kind}`", one.is_reached, _why_not(one))
    reached = [one for one in crossings if one.is_reached]
    slow = [one for one in reached if one.seconds > one.allowed]
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


def _cross(kind: str) -> Crossing:
    """Start the launch beside a robot in a world drawn anew, and send it a goal."""
    where, goal, way = _drawn(kind)
    robot = a_robot(where, factor=FACTOR, patience=LATE)
    launch = start("ros2", "launch", "explorer", "explorer.launch.py", "use_sim_time:=true")
    client = _client(launch)
    told = hear_tf()
    wait(lambda: told.has("map", "base_link"), TF_TIMEOUT, "map → base_link on tf", poll=0.2)
    begins = place_in(told.buffer(), "map", "base_link")
    simulation, number = robot.simulation, robot.vehicle.number
    began = simulation.time
    heading = chance().uniform(-math.pi, math.pi)
    seen = between(where.start, (*goal, heading))
    sent = client.send(pose=stamped_pose(seen, "map", Time(nanoseconds=simulation.nanoseconds).to_msg()))
    crossing = Crossing(kind, where.seed or 0, way, "", 0.0, 0.0, 0, _has_own(), begins)
    wait(
        lambda: not sent.accepted or sent.status is not None or simulation.time - began > crossing.allowed,
        REAL_TIMEOUT,
        f"the end of the journey in {crossing}",
        poll=0.05,
    )
    crossing.word, crossing.seconds = sent.word, simulation.time - began
    crossing.own = crossing.own or _has_own()
    crossing.away = math.dist(simulation.true_place(number)[:2], goal)
    crossing.bumps = robot.vehicle.bumps
    if not crossing.is_reached:
        nodes = current().stage.their_nodes()
        crossing.by_own_clock = [node for node in nodes if get_parameters(node, "use_sim_time") == [False]]
    launch.stop(5.0)
    current().stage.tidy()
    return crossing


def _drawn(kind: str) -> tuple[World, tuple[float, float], float]:
    """A world of a kind, the place to go to, and the metres of the shortest way there."""
    while True:
        where = world(kind, chance().randrange(1_000, 1_000_000))
        ways = [(_length(a_way(where, where.start[:2], goal)), goal) for goal in where.goals]
        fitting = [one for one in ways if SHORTEST < one[0] < LONGEST]
        if fitting:
            way, goal = min(fitting)
            return where, goal, way


def _length(way: list[tuple[float, float]]) -> float:
    return sum(math.dist(a, b) for a, b in pairwise(way))


def _client(launch: Process) -> Client:
    """A client of the launch's action, once that is there."""
    station = current().stage

    def is_offered() -> bool:
        station.examine_processes(started())
        actions = {name for node in station.offered() for name in node.action_servers}
        return "/navigate_to_pose" in actions or not launch.is_running

    wait(is_offered, BEGIN_TIMEOUT, "the action /navigate_to_pose of the launch", poll=0.2)
    hint = f"{said(launch, 4)}`ros2 launch explorer explorer.launch.py` says why."
    require("the launch runs", launch.is_running, hint)
    return expect_action("/navigate_to_pose", NavigateToPose)


def _has_own() -> bool:
    """Whether what publishes the judged topics, or serves /get_plan, is a program of the workspace."""
    node = current().stage.node
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
    hint = f"In {one} the goal, {one.way:.1f} m of way from the start, is {one.word} after {one.seconds:.0f} s"
    hint += f", and the robot {one.away:.2f} m from it"
    hint += f", with {one.bumps} bumps. " if one.bumps else ". "
    if one.word == "rejected":
        return f"{hint}Accept goals in `map`, however far: nobody knows the map before."
    if one.by_own_clock:
        return f"{hint}{', '.join(one.by_own_clock)} goes by the machine's clock: hand `use_sim_time` on to every node."
    if one.begins is None:
        return f"{hint}tf does not tell where base_link is in `map`: that is for who makes the map."
    if math.hypot(*one.begins[:2]) > ELSEWHERE:
        x, y, _ = one.begins
        return f"{hint}By tf the robot begins at ({x:.1f}, {y:.1f}) of `map`, and not at (0, 0): no `initial_pose`."
    if one.word == "succeeded":
        return f"{hint}Succeed when tf says that base_link is where the goal is in `map`, and not before."
    return (
        f"{hint}See it drive: `run(Robot, world={one.kind!r}, seed={one.seed}, factor=4.0)`, your launch, and "
        "`show_robot`. A path into the unknown must be planned anew when the map grows."
    )
