"""The nodes of navigation on real topics: a robot drives to goals, on a map that it makes or has.

Simulated time runs at FACTOR and stands still while a command is late, so a busy machine makes it slower, not worse.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseArray, PoseStamped, PoseWithCovarianceStamped, TwistStamped
from nav2_msgs.action import NavigateToPose
from nav_msgs.msg import OccupancyGrid, Path
from nav_msgs.srv import GetPlan
from rclpy.action import ActionClient
from rclpy.action.client import ClientGoalHandle
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.task import Future
from sensor_msgs.msg import LaserScan
from std_srvs.srv import Empty
from tf2_ros import StaticTransformBroadcaster

from course_kit import run, stop
from course_kit.robots.navigation import planning
from course_kit.robots.navigation.grid_map import GridMap
from course_kit.robots.navigation.localizer import Localizer
from course_kit.robots.navigation.mapper import Mapper
from course_kit.robots.navigation.messages import (
    LATCHED,
    heading,
    map_message,
    map_of,
    path_message,
    place_of,
    points_of,
    pose_of,
    rays_of,
    stamped_pose,
    transform_of,
)
from course_kit.robots.navigation.navigator import TF_ERROR, TIMEOUT, Navigator
from course_kit.robots.navigation.places import Place, after
from course_kit.robots.navigation.planner import Planner
from course_kit.robots.robot.node import Robot
from course_kit.robots.robot.world import Pillar, Wall, World
from course_kit.robots.robot.worlds import world
from course_kit.ros import packages
from tests.crossing import errors, rightness, true_map
from tests.waiting import wait_until

pytestmark = [
    pytest.mark.cpu_bound,
    pytest.mark.usefixtures("fresh_domain"),
    pytest.mark.by_turns("nodes that drive for minutes"),
]

FACTOR, PATIENCE = 4.0, 60.0
LONG = 90.0  # seconds of real time for a journey: on an idle machine it takes a tenth
EMPTY = world("empty")


def simulated(**parameters: Any) -> list[Parameter]:
    return [Parameter(name, value=value) for name, value in {"use_sim_time": True, **parameters}.items()]


def start_robot(where: World) -> Robot:
    return run(Robot, world=where, factor=FACTOR, parameter_overrides=[Parameter("patience", value=PATIENCE)])


class DomainObserver(Node):
    """What a person has before them: goals to send, topics to look at."""

    def __init__(self) -> None:
        super().__init__("station", parameter_overrides=simulated())
        self.client = ActionClient(self, NavigateToPose, "navigate_to_pose")
        self.feedback: list[NavigateToPose.Feedback] = []
        self.heard: dict[str, list[Any]] = {}
        for kind, topic, qos in (
            (OccupancyGrid, "map", LATCHED),
            (Path, "plan", 10),
            (PoseWithCovarianceStamped, "amcl_pose", LATCHED),
            (PoseArray, "particle_cloud", 10),
            (TwistStamped, "cmd_vel", 10),
        ):
            self.create_subscription(kind, topic, self.heard.setdefault(topic, []).append, qos)

    def publish_map(self, grid_map: GridMap) -> None:
        self.maps = self.create_publisher(OccupancyGrid, "map", LATCHED)
        self.maps.publish(map_message(grid_map, "map", self.get_clock().now().to_msg()))

    def send(self, goal: Place, frame: str = "map") -> ClientGoalHandle:
        wait_until(self.client.server_is_ready, "navigate_to_pose")
        pose = stamped_pose(goal, frame, self.get_clock().now().to_msg())
        self.feedback.clear()
        sent = self.client.send_goal_async(
            NavigateToPose.Goal(pose=pose), lambda message: self.feedback.append(message.feedback)
        )
        wait_until(sent.done, "an answer to the goal")
        handle = sent.result()
        assert handle is not None
        return handle


def result(handle: ClientGoalHandle) -> tuple[int, NavigateToPose.Result]:
    future = handle.get_result_async()
    wait_until(future.done, "the goal's result", LONG)
    answer = future.result()
    assert answer is not None
    return answer.status, answer.result


@pytest.fixture
def station(monkeypatch: pytest.MonkeyPatch) -> Iterator[DomainObserver]:
    monkeypatch.setattr("course_kit.robots.navigation.navigator.ANSWER", PATIENCE)
    yield run(DomainObserver)
    stop()


def run_mapping(robot: Robot) -> None:
    run(Mapper, parameter_overrides=simulated(initial_pose=list(robot.world.start)))
    run(Planner, parameter_overrides=simulated())
    run(Navigator, parameter_overrides=simulated())


def run_on_map(station: DomainObserver, known: World, **parameters: Any) -> None:
    station.publish_map(true_map(known))
    x, y, yaw = known.start
    pose = {"set_initial_pose": True, "initial_pose.x": x, "initial_pose.y": y, "initial_pose.yaw": yaw}
    run(Localizer, parameter_overrides=simulated(**{**pose, **parameters}))
    run(Planner, parameter_overrides=simulated())
    run(Navigator, parameter_overrides=simulated())


def true_place(robot: Robot) -> Place:
    return robot.simulation.true_place(robot.vehicle.number)


# Messages


def test_a_map_as_message_has_its_corner_at_the_origin_and_its_rows_up_y() -> None:
    cells = np.array([[0, 100, -1], [7, 8, 9]], np.int8)
    message = map_message(GridMap(cells, 0.05, (-1.5, 2.0)), "map", Time(sec=1))
    info = message.info
    assert (info.width, info.height, list(message.data)) == (3, 2, [0, 100, -1, 7, 8, 9])
    assert (info.origin.position.x, info.origin.position.y, heading(info.origin.orientation)) == (-1.5, 2.0, 0.0)
    back = map_of(message)
    assert (back.cells.tolist(), back.resolution, back.origin) == (cells.tolist(), 0.05, (-1.5, 2.0))
    message.info.width = 4
    with pytest.raises(ValueError, match="6 cells, but its info says 4 by 2"):
        map_of(message)
    message.info.width, message.info.origin = 3, pose_of((0.0, 0.0, 1.0))
    with pytest.raises(ValueError, match=r"turned by 1.000 rad"):
        map_of(message)


def test_ranges_mean_what_rep_117_says() -> None:
    ranges = [1.0, math.inf, -math.inf, math.nan, 0.05, 4.0, 3.5]
    scan = LaserScan(angle_min=0.5, angle_increment=0.1, range_min=0.12, range_max=3.5, ranges=ranges)
    angles, read = rays_of(scan)
    assert angles[:2] == pytest.approx([0.5, 0.6])
    assert [f"{one:g}" for one in read] == ["1", "inf", "nan", "nan", "nan", "inf", "3.5"]


def test_a_pose_is_the_place_that_it_was_made_of() -> None:
    for place in ((1.0, -2.0, 3.0), (0.0, 0.0, -3.1), (0.0, 0.0, 0.0)):
        assert errors(place_of(pose_of(place)), place) == pytest.approx((0, 0), abs=1e-12)


# Journeys


def test_it_maps_an_unknown_world_on_its_way_to_a_goal_and_arrives(station: DomainObserver) -> None:
    robot = start_robot(world("office", 7))
    run_mapping(robot)
    goal = (*min(robot.world.goals, key=lambda one: math.dist(one, robot.world.start[:2])), 0.0)
    status, ended = result(station.send(goal))
    assert (status, ended.error_code) == (GoalStatus.STATUS_SUCCEEDED, 0), ended.error_msg
    metres, radians = errors(true_place(robot), goal)
    assert metres < 0.25
    assert radians < 0.2
    assert robot.vehicle.bumps == 0
    first, last = station.feedback[0], station.feedback[-1]
    assert first.distance_remaining > 1 > 0.2 > last.distance_remaining
    assert last.navigation_time.sec > 5
    assert last.current_pose.header.frame_id == "map"
    made = station.heard["map"][-1]
    assert made.header.frame_id == "map"
    right, walls = rightness(map_of(made), robot.world)
    assert right > 0.95
    assert walls > 0.9


def test_on_a_given_map_it_knows_where_it_is_and_drives_around_what_is_not_on_it(station: DomainObserver) -> None:
    known = replace(EMPTY, start=(1.0, 1.0, 0.0))
    robot = start_robot(replace(known, pillars=(Pillar(2.0, 1.1, 0.2),)))
    run_on_map(station, known)
    goal = (3.0, 1.0, 1.0)
    status, ended = result(station.send(goal))
    assert (status, ended.error_code) == (GoalStatus.STATUS_SUCCEEDED, 0), ended.error_msg
    assert errors(true_place(robot), goal)[0] < 0.2
    assert robot.vehicle.bumps == 0
    pose = station.heard["amcl_pose"][-1]
    assert (pose.header.frame_id, len(pose.pose.covariance)) == ("map", 36)
    assert 0 < pose.pose.covariance[0] < 0.1
    assert len(station.heard["particle_cloud"][-1].poses) > 100
    # With a plan around the pillar.
    paths = [points_of(path) for path in station.heard["plan"] if path.poses]
    assert min(np.hypot(*(paths[-1] - (2.0, 1.1)).T)) > 0.3


def test_it_plans_anew_as_soon_as_its_map_has_what_stands_on_its_path(station: DomainObserver) -> None:
    goal, edge = (5.2, 2.5, 0.0), 4.5
    screen = Wall(edge + 0.05, 2.5, 0.1, 0.8)  # across the way, and too far for the laser at first
    robot = start_robot(replace(EMPTY, start=(0.7, 2.5, 0.0), walls=(*EMPTY.walls, screen)))
    run_mapping(robot)
    status, ended = result(station.send(goal))
    assert (status, ended.error_code) == (GoalStatus.STATUS_SUCCEEDED, 0), ended.error_msg
    assert errors(true_place(robot), goal)[0] < 0.2
    assert robot.vehicle.bumps == 0
    assert station.feedback[-1].number_of_recoveries >= 1
    assert station.feedback[-1].navigation_time.sec < 60
    first, second, *_ = (points_of(path) for path in station.heard["plan"] if path.poses)
    alone = replace(EMPTY, walls=(screen,))
    assert alone.clearances(*first.T).min() < 0 < 0.1 < alone.clearances(*second.T).min()
    # The map has told it on its way: it did not drive there and stand before the screen.
    assert second[0][0] < edge - 0.5


def test_a_goal_that_is_cancelled_stops_the_robot(station: DomainObserver) -> None:
    robot = start_robot(replace(EMPTY, start=(1.0, 1.0, 0.0)))
    run_mapping(robot)
    handle = station.send((5.0, 1.0, 0.0))
    wait_until(lambda: station.feedback and station.feedback[-1].distance_remaining < 3.5, "the robot on its way")
    cancelled = handle.cancel_goal_async()
    wait_until(cancelled.done, "an answer to the cancel")
    status, _ = result(handle)
    assert status == GoalStatus.STATUS_CANCELED
    wait_until(lambda: abs(robot.simulation.true_twist(robot.vehicle.number)[0]) < 1e-3, "a robot at rest")
    assert true_place(robot)[0] < 3.0
    last = station.heard["cmd_vel"][-1].twist
    assert (last.linear.x, last.angular.z) == (0.0, 0.0)


def test_a_new_goal_takes_the_place_of_the_one_that_runs_also_by_goal_pose(station: DomainObserver) -> None:
    robot = start_robot(replace(EMPTY, start=(3.0, 2.5, 0.0)))
    run_mapping(robot)
    handle = station.send((5.0, 2.5, 0.0))
    wait_until(lambda: station.feedback, "feedback")
    arrow = station.create_publisher(PoseStamped, "goal_pose", 1)
    wait_until(lambda: arrow.get_subscription_count() == 2, "navigator and planner listening")
    arrow.publish(stamped_pose((2.2, 2.5, math.pi), "map", station.get_clock().now().to_msg()))
    status, ended = result(handle)
    assert status == GoalStatus.STATUS_ABORTED
    assert "another goal" in ended.error_msg
    wait_until(lambda: errors(true_place(robot), (2.2, 2.5, math.pi))[0] < 0.15, "the second goal reached", LONG)


@pytest.mark.parametrize(
    ("goal", "frame", "code", "words"),
    [
        ((6.0, 2.0, 0.0), "map", planning.GOAL_OCCUPIED, "wall"),
        ((1.0, 1.0, 0.0), "moon", TF_ERROR, "tf does not tell where the frame 'moon' is"),
    ],
)
def test_a_goal_that_cannot_be_is_aborted_with_the_reason(
    station: DomainObserver, goal: Place, frame: str, code: int, words: str
) -> None:
    run_mapping(start_robot(replace(EMPTY, start=(4.0, 2.0, 0.0))))
    wait_until(lambda: station.heard["map"], "a map")
    status, ended = result(station.send(goal, frame))
    assert (status, ended.error_code) == (GoalStatus.STATUS_ABORTED, code)
    assert words in ended.error_msg


def test_without_a_planner_it_says_so(station: DomainObserver, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("course_kit.robots.navigation.navigator.ANSWER", 3.0)
    robot = start_robot(EMPTY)
    run(Mapper, parameter_overrides=simulated(initial_pose=list(robot.world.start)))
    navigator = run(Navigator, parameter_overrides=simulated())
    wait_until(navigator.place, "the robot on the map")
    status, ended = result(station.send((5.0, 4.0, 0.0)))
    assert status == GoalStatus.STATUS_ABORTED
    # On a machine that is busy for so long tf may be missing first.
    words = {TIMEOUT: "get_plan", TF_ERROR: "tf has told"}[ended.error_code]
    assert words in ended.error_msg


class Loser(Node):
    """A planner whose first answer comes when it is asked again, or is lost on the way; or the others are lost.

    What is not lost leads straight to the goal.
    """

    def __init__(self, loses_the_first: bool, **options: Any) -> None:
        super().__init__("planner", **options)
        self.loses_the_first = loses_the_first
        self.requests, self.asked_again = 0, Future()
        self.create_service(GetPlan, "get_plan", self.on_request, callback_group=ReentrantCallbackGroup())

    async def on_request(self, request: GetPlan.Request, response: GetPlan.Response) -> GetPlan.Response:
        self.requests += 1
        is_first = self.requests == 1
        if self.requests == 2:
            self.asked_again.set_result(None)
        if is_first:
            await self.asked_again
        if is_first == self.loses_the_first:
            await Future()
        (x, y, _), goal = (place_of(one.pose) for one in (request.start, request.goal))
        points = np.linspace((x, y), goal[:2], 20)
        response.plan = path_message(points, goal[2], "map", request.start.header.stamp)
        return response


@pytest.mark.parametrize("loses_the_first", [True, False])
def test_a_planner_is_asked_again_and_the_first_answer_counts(
    station: DomainObserver, monkeypatch: pytest.MonkeyPatch, loses_the_first: bool
) -> None:
    monkeypatch.setattr("course_kit.robots.navigation.navigator.LOST", 0.5)
    robot = start_robot(replace(EMPTY, start=(1.0, 1.0, 0.0)))
    run(Mapper, parameter_overrides=simulated(initial_pose=list(robot.world.start)))
    planner = run(Loser, loses_the_first=loses_the_first, parameter_overrides=simulated())
    run(Navigator, parameter_overrides=simulated())
    status, ended = result(station.send((1.5, 1.0, 0.0)))
    assert (status, ended.error_code) == (GoalStatus.STATUS_SUCCEEDED, 0), ended.error_msg
    assert planner.requests >= 2


# Parts


def test_a_plan_is_asked_for_by_service_and_one_without_poses_is_none(station: DomainObserver) -> None:
    robot = start_robot(EMPTY)
    station.publish_map(true_map(robot.world))
    run(Planner, parameter_overrides=simulated(allow_unknown=False))
    client = station.create_client(GetPlan, "get_plan")
    wait_until(client.service_is_ready, "get_plan")

    def ask(goal: Place) -> Path:
        now = station.get_clock().now().to_msg()
        start, end = (stamped_pose(one, "map", now) for one in ((1.0, 1.0, 0.0), goal))
        answer = client.call_async(GetPlan.Request(start=start, goal=end))
        wait_until(answer.done, "a plan")
        return answer.result().plan

    path = wait_until(lambda: (found := ask((5.0, 4.0, 2.0))).poses and found, "a plan once the map is there")
    assert path.header.frame_id == path.poses[0].header.frame_id == "map"
    assert errors(place_of(path.poses[-1].pose), (5.0, 4.0, 2.0)) == pytest.approx((0, 0), abs=1e-6)
    assert heading(path.poses[len(path.poses) // 2].pose.orientation) == pytest.approx(math.atan2(3, 4), abs=0.2)
    assert ask((6.0, 4.0, 0.0)).poses == []


@pytest.mark.parametrize("late", ["tf", "listener"])
def test_a_goal_waits_for_tf_and_for_who_listens_to_its_plan(
    station: DomainObserver, monkeypatch: pytest.MonkeyPatch, late: str
) -> None:
    monkeypatch.setattr("course_kit.robots.navigation.planner.WAIT", PATIENCE)
    station.destroy_subscription(next(one for one in station.subscriptions if one.topic_name == "/plan"))
    station.publish_map(true_map(EMPTY))
    planner = run(Planner, parameter_overrides=simulated())
    goals = station.create_publisher(PoseStamped, "goal_pose", 1)
    wait_until(lambda: planner.map and goals.get_subscription_count(), "a planner with a map")
    broadcaster = StaticTransformBroadcaster(station)
    plans: list[Path] = []

    def tell_tf() -> None:
        broadcaster.sendTransform(transform_of(EMPTY.start, "map", "base_link", Time()))
        wait_until(lambda: planner.frames.place("map", "base_link"), "tf at the planner")

    def listen() -> None:
        station.create_subscription(Path, "plan", plans.append, 10)
        wait_until(planner.publisher.get_subscription_count, "the planner seeing who listens")

    steps = {"tf": tell_tf, "listener": listen}
    last = steps.pop(late)
    for step in steps.values():
        step()
    goals.publish(stamped_pose((5.0, 4.0, 0.0), "map", Time()))
    wait_until(lambda: not planner.retry.is_canceled(), "the planner waiting")
    last()
    wait_until(lambda: plans, "a plan")
    assert place_of(plans[0].poses[-1].pose) == pytest.approx((5.0, 4.0, 0.0), abs=1e-6)


def test_the_localizer_begins_anywhere_or_where_it_is_told(station: DomainObserver) -> None:
    robot = start_robot(world("rooms"))
    station.publish_map(true_map(robot.world))
    localizer = run(Localizer, parameter_overrides=simulated())
    wait_until(lambda: station.heard["amcl_pose"], "a pose")
    told = station.create_publisher(PoseWithCovarianceStamped, "initialpose", 1)
    wait_until(told.get_subscription_count, "the localizer listening")
    guess = PoseWithCovarianceStamped()
    guess.pose.pose = pose_of(after(robot.world.start, (0.1, 0.1, 0.1)))
    guess.pose.covariance[0] = guess.pose.covariance[7] = guess.pose.covariance[35] = 0.04
    told.publish(guess)

    def is_right() -> bool:
        place = place_of(station.heard["amcl_pose"][-1].pose.pose)
        return errors(place, robot.world.start)[0] < 0.15

    wait_until(is_right, "the robot where it is")
    assert localizer.filter is not None
    assert localizer.filter.is_together
    scatter = station.create_client(Empty, "reinitialize_global_localization")
    wait_until(scatter.service_is_ready, "the service")
    done = scatter.call_async(Empty.Request())
    wait_until(done.done, "an answer")
    assert localizer.start is None


def test_the_nodes_are_programs_of_a_package() -> None:
    names = [path.name for path in packages.executables("course_navigation")]
    assert sorted(names) == ["localizer", "mapper", "navigator", "planner"]
