"""The node turtlesim as the ROS graph sees it, on each of rclpy's executors and as a process of its own."""

from __future__ import annotations

import math
import signal
import subprocess
import sys
import threading
import time
import warnings
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
import rclpy
from action_msgs.msg import GoalStatus
from geometry_msgs.msg import Twist
from PIL import Image
from rcl_interfaces.msg import Log, ParameterType
from rcl_interfaces.srv import DescribeParameters
from rclpy.action import ActionClient
from rclpy.action.graph import get_action_server_names_and_types_by_node
from rclpy.exceptions import InvalidHandle
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor, ShutdownException, SingleThreadedExecutor
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.task import Future
from std_srvs.srv import Empty
from turtlesim.action import RotateAbsolute
from turtlesim.msg import Color, Pose
from turtlesim.srv import Kill, SetPen, Spawn, TeleportAbsolute, TeleportRelative

from course_kit.robots.turtlesim.node import TurtleSim
from course_kit.ros.interface_types import type_name
from course_kit.ros.spinning.nodes import destroy
from tests.waiting import TIMEOUT, wait_until

pytestmark = pytest.mark.by_turns("many nodes and programs")

EXECUTORS: dict[str, Callable[..., Any]] = {
    "single": SingleThreadedExecutor,
    "multi": lambda context: MultiThreadedExecutor(4, context=context),
    "events": EventsExecutor,
}
MIDDLE = 5.544444561004639
WHITE, PEN = (255, 255, 255), (179, 184, 255)
TURTLE_TOPICS = {"cmd_vel": Twist, "pose": Pose, "color_sensor": Color}
TURTLE_SERVICES = {
    "set_pen": SetPen,
    "teleport_absolute": TeleportAbsolute,
    "teleport_relative": TeleportRelative,
}
LOG_LEVELS = {20: "info", 30: "warn", 40: "error"}


class Spinning:
    """An executor in a thread; `errors` is what came out of it."""

    def __init__(self, executor: Any, node: Node) -> None:
        self.executor = executor
        self.node = node
        self.errors: list[BaseException] = []
        self._end = Future()
        executor.add_node(node)
        self._thread = threading.Thread(target=self._spin, daemon=True)
        self._thread.start()

    def _spin(self) -> None:
        while not self._end.done():
            try:
                # With a timeout, because the EventsExecutor hangs without one.
                self.executor.spin_until_future_complete(self._end, timeout_sec=3600)
            except (ExternalShutdownException, ShutdownException):
                return
            except InvalidHandle as error:
                # rclpy's MultiThreadedExecutor takes what is ready in one thread while another one destroys it.
                if not isinstance(self.executor, MultiThreadedExecutor):
                    self.errors.append(error)
            except BaseException as error:
                self.errors.append(error)

    def stop(self) -> None:
        """Destroy the node in its executor, as course_kit does, and end the thread."""
        destroyed = self.executor.create_task(destroy, self.node)
        wait_until(destroyed.done, "end of the node: its executor runs no tasks")
        self._end.set_result(None)
        self.executor.create_task(lambda: None)
        self._thread.join(TIMEOUT)
        assert not self._thread.is_alive()
        self.executor.shutdown(timeout_sec=1)


class Ros:
    """A context of its own with an observer node, which does what a student's programs do."""

    def __init__(self) -> None:
        self.context = rclpy.Context()
        arguments = ["--ros-args", "--disable-external-lib-logs", "--disable-stdout-logs"]
        rclpy.init(args=arguments, context=self.context)
        self.observer = Node("observer", context=self.context)
        self._executor = SingleThreadedExecutor(context=self.context)
        self._spinning = [Spinning(self._executor, self.observer)]
        self.logged: list[tuple[str, str, str]] = []  # node, level, text
        qos = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.observer.create_subscription(Log, "/rosout", self._on_log, qos)

    def _on_log(self, log: Log) -> None:
        self.logged.append((log.name, LOG_LEVELS[log.level], log.msg))

    def run(self, executor: str = "single", **options: Any) -> TurtleSim:
        """A simulator, spinning."""
        node = TurtleSim(context=self.context, **options)
        self._spinning.append(Spinning(EXECUTORS[executor](context=self.context), node))
        return node

    def wait_for_log(self, level: str, text: str, node: str = "turtlesim") -> None:
        """Wait for a line in the log."""
        wait_until(lambda: (node, level, text) in self.logged, f"line {text!r} in the log")

    def errors(self) -> list[BaseException]:
        """What came out of the executors."""
        return [error for spinning in self._spinning for error in spinning.errors]

    def end(self) -> None:
        """Stop everything."""
        for spinning in reversed(self._spinning):
            spinning.stop()
        rclpy.shutdown(context=self.context)

    def call(self, kind: Any, name: str, /, **fields: Any) -> Any:
        """Call a service and return its answer."""
        client = self.observer.create_client(kind, name)
        wait_until(client.service_is_ready, f"service {name}")
        answer = self.wait(client.call_async(kind.Request(**fields)), f"answer of {name}")
        self.observer.destroy_client(client)
        return answer

    def wait(self, future: Future, what: str, timeout: float = TIMEOUT) -> Any:
        """The result of a future that the observer's executor completes."""
        wait_until(future.done, what, timeout)
        return future.result()

    def listen(self, kind: Any, topic: str) -> list[Any]:
        """A list that grows by the messages on a topic; the first is waited for."""
        messages: list[Any] = []
        self.observer.create_subscription(kind, topic, messages.append, QoSProfile(depth=1000))
        wait_until(lambda: messages, f"message on {topic}")
        return messages

    def publisher(self, topic: str = "turtle1/cmd_vel") -> Any:
        """A publisher of velocities, matched."""
        publisher = self.observer.create_publisher(Twist, topic, 10)
        wait_until(publisher.get_subscription_count, f"subscription of {topic}")
        return publisher

    def rotation_client(self, turtle: str = "turtle1") -> ActionClient:
        """An action client, matched."""
        client = ActionClient(self.observer, RotateAbsolute, f"{turtle}/rotate_absolute")
        wait_until(client.server_is_ready, f"action {turtle}/rotate_absolute")
        return client

    def request(self, ask: Callable[..., Future], *arguments: Any) -> Future:
        """Ask in the executor's thread: else an answer may come before rclpy has noted the request."""
        return self.wait(self._executor.create_task(ask, *arguments), "request")

    def send(self, client: ActionClient, theta: float, feedback: list[float] | None = None) -> Any:
        """Send a goal and return its handle."""

        def on_feedback(message: Any) -> None:
            if feedback is not None:
                feedback.append(message.feedback.remaining)

        goal = RotateAbsolute.Goal(theta=theta)
        return self.wait(self.request(client.send_goal_async, goal, on_feedback), "answer to the goal")

    def result(self, handle: Any) -> Any:
        """Wait for the result of a goal."""
        return self.wait(self.request(handle.get_result_async), "result")


def twist(forward: float = 0.0, turning: float = 0.0, sideways: float = 0.0) -> Twist:
    message = Twist()
    message.linear.x, message.linear.y, message.angular.z = forward, sideways, turning
    return message


@pytest.fixture
def ros(capfd: pytest.CaptureFixture[str]) -> Iterator[Ros]:
    ros = Ros()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield ros
        ros.end()
    assert ros.errors() == []
    assert capfd.readouterr().err == ""


@pytest.fixture(params=list(EXECUTORS))
def sim(ros: Ros, request: pytest.FixtureRequest) -> TurtleSim:
    return ros.run(request.param)


# What is in the graph


def expected_graph(turtles: set[str]) -> dict[str, dict[str, str]]:
    """The names that the facts give, in the root namespace, with their types."""
    fixed = {"clear": Empty, "reset": Empty, "spawn": Spawn, "kill": Kill}
    return {
        "publishers": {
            f"/{turtle}/{topic}": type_name(TURTLE_TOPICS[topic])
            for turtle in turtles
            for topic in ("pose", "color_sensor")
        },
        "subscriptions": {f"/{turtle}/cmd_vel": type_name(Twist) for turtle in turtles},
        "services": {f"/{name}": type_name(kind) for name, kind in fixed.items()}
        | {f"/{turtle}/{name}": type_name(kind) for turtle in turtles for name, kind in TURTLE_SERVICES.items()},
        "actions": {f"/{turtle}/rotate_absolute": type_name(RotateAbsolute) for turtle in turtles},
    }


def seen_graph(observer: Node) -> dict[str, dict[str, str]]:
    """What another node sees of /turtlesim, without what every node has and an action's parts."""
    node = ("turtlesim", "/")
    lists = {
        "publishers": observer.get_publisher_names_and_types_by_node(*node),
        "subscriptions": observer.get_subscriber_names_and_types_by_node(*node),
        "services": observer.get_service_names_and_types_by_node(*node),
        "actions": get_action_server_names_and_types_by_node(observer, *node),
    }
    common = ("/parameter_events", "/rosout", "/turtlesim/", "/_")  # the last are hidden
    return {
        kind: {
            name: types[0]
            for name, types in names
            if not name.startswith(common) and "/_action/" not in name and len(types) == 1
        }
        for kind, names in lists.items()
    }


def wait_for_graph(ros: Ros, turtles: set[str]) -> None:
    def matches() -> bool:
        try:
            return seen_graph(ros.observer) == expected_graph(turtles)
        except rclpy.node.NodeNameNonExistentError:
            return False

    wait_until(matches, f"graph with exactly {turtles}")


def test_names_and_types(ros: Ros, sim: TurtleSim) -> None:
    wait_for_graph(ros, {"turtle1"})


def test_topics_are_reliable_volatile_and_keep_7(ros: Ros, sim: TurtleSim) -> None:
    endpoints: list[Any] = [*sim.publishers, *sim.subscriptions]
    ours = [
        endpoint.qos_profile
        for endpoint in endpoints
        if endpoint.topic_name.startswith(("/turtle1/", "turtle1/")) and "_action" not in endpoint.topic_name
    ]
    assert [(qos.history, qos.depth) for qos in ours] == [(HistoryPolicy.KEEP_LAST, 7)] * 3
    wait_for_graph(ros, {"turtle1"})
    seen = [
        *ros.observer.get_publishers_info_by_topic("/turtle1/pose"),
        *ros.observer.get_publishers_info_by_topic("/turtle1/color_sensor"),
        *ros.observer.get_subscriptions_info_by_topic("/turtle1/cmd_vel"),
    ]
    policies = [(info.qos_profile.reliability, info.qos_profile.durability) for info in seen]
    assert policies == [(ReliabilityPolicy.RELIABLE, DurabilityPolicy.VOLATILE)] * 3


def test_parameters(ros: Ros, sim: TurtleSim) -> None:
    names = ["background_r", "background_g", "background_b", "holonomic"]
    assert [sim.get_parameter(name).value for name in names] == [69, 86, 255, False]
    answer = ros.call(DescribeParameters, "turtlesim/describe_parameters", names=names)
    for descriptor in answer.descriptors[:3]:
        assert descriptor.type == ParameterType.PARAMETER_INTEGER
        limits = descriptor.integer_range[0]
        assert (limits.from_value, limits.to_value, limits.step) == (0, 255, 1)
    assert answer.descriptors[3].type == ParameterType.PARAMETER_BOOL


def test_parameter_out_of_range_is_refused(ros: Ros, sim: TurtleSim) -> None:
    parameters = AsyncParameterClient(ros.observer, "turtlesim")
    wait_until(parameters.services_are_ready, "parameter services")
    future = parameters.set_parameters([Parameter("background_r", value=256)])
    assert not ros.wait(future, "answer").results[0].successful
    assert sim.get_parameter("background_r").value == 69


def test_background_shows_in_the_picture_at_once(ros: Ros, sim: TurtleSim) -> None:
    assert sim.picture().getpixel((5, 5)) == (69, 86, 255)
    parameters = AsyncParameterClient(ros.observer, "turtlesim")
    wait_until(parameters.services_are_ready, "parameter services")
    changes = [Parameter("background_r", value=150), Parameter("background_b", value=0)]
    ros.wait(parameters.set_parameters(changes), "answer")
    assert sim.picture().getpixel((5, 5)) == (150, 86, 0)


def test_start_is_logged_with_the_full_name(ros: Ros) -> None:
    ros.run(namespace="/robot1")
    wait_until(lambda: len(ros.logged) >= 2, "log")
    assert ros.logged[:2] == [
        ("robot1.turtlesim", "info", "Starting turtlesim with node name /robot1/turtlesim"),
        (
            "robot1.turtlesim",
            "info",
            "Spawning turtle [turtle1] at x=[5.544445], y=[5.544445], theta=[0.000000]",
        ),
    ]


# Driving


def test_pose_and_colour_are_published(ros: Ros, sim: TurtleSim) -> None:
    pose = ros.listen(Pose, "turtle1/pose")[-1]
    assert (pose.x, pose.y, pose.theta) == (MIDDLE, MIDDLE, 0.0)
    color = ros.listen(Color, "turtle1/color_sensor")[-1]
    assert (color.r, color.g, color.b) == WHITE


def test_one_command_moves_the_turtle_about_2_metres(ros: Ros, sim: TurtleSim) -> None:
    publisher = ros.publisher()
    poses = ros.listen(Pose, "turtle1/pose")
    publisher.publish(twist(2.0))
    wait_until(lambda: poses[-1].x > MIDDLE and poses[-1].linear_velocity == 0, "end of the way")
    # 62 or 63 ticks of 0.032 m; a busy machine may skip many, which the fixed dt does not make up for.
    assert 0.3 < poses[-1].x - MIDDLE <= 63.5 * 0.032
    assert poses[-1].y == MIDDLE
    steps = np.diff([pose.x for pose in poses])
    assert steps[steps > 0] == pytest.approx(0.032, abs=1e-5)


def test_turtle_goes_sideways_only_while_holonomic(ros: Ros, sim: TurtleSim) -> None:
    publisher = ros.publisher()
    poses = ros.listen(Pose, "turtle1/pose")
    publisher.publish(twist(0.0, sideways=1.0))
    publisher.publish(twist(1.0, sideways=1.0))
    wait_until(lambda: poses[-1].x > MIDDLE, "movement")
    assert poses[-1].y == MIDDLE
    sim.set_parameters([Parameter("holonomic", value=True)])
    publisher.publish(twist(0.0, sideways=1.0))
    wait_until(lambda: poses[-1].y > MIDDLE, "movement to the left")


def test_wall_is_logged_as_a_warning(ros: Ros, sim: TurtleSim) -> None:
    ros.call(TeleportAbsolute, "turtle1/teleport_absolute", x=11.0, y=MIDDLE, theta=0.0)
    ros.publisher().publish(twist(2.0))
    line = ("turtlesim", "warn", "Oh no! I hit the wall! (Clamping from [x=11.120889, y=5.544445])")
    wait_until(lambda: ros.logged.count(line) > 5, "warning of the wall")


# Services


def test_pen_and_teleports(ros: Ros, sim: TurtleSim) -> None:
    poses = ros.listen(Pose, "turtle1/pose")
    colors = ros.listen(Color, "turtle1/color_sensor")
    ros.call(SetPen, "turtle1/set_pen", r=1, g=2, b=3, width=5, off=0)
    ros.call(TeleportAbsolute, "turtle1/teleport_absolute", x=2.0, y=3.0, theta=0.0)
    ros.call(TeleportRelative, "turtle1/teleport_relative", linear=1.0, angular=math.pi / 2)
    wait_until(lambda: (colors[-1].r, colors[-1].g, colors[-1].b) == (1, 2, 3), "colour of the pen")
    wait_until(lambda: poses[-1].y > 3.5, "end of the second teleport")
    assert (poses[-1].x, poses[-1].y) == pytest.approx((2.0, 4.0), abs=1e-5)
    assert poses[-1].theta == pytest.approx(math.pi / 2)
    assert sim.picture().getpixel((90, 360)) == (1, 2, 3)
    ros.call(Empty, "clear")
    wait_until(lambda: (colors[-1].r, colors[-1].g, colors[-1].b) == WHITE, "blank field")
    ros.wait_for_log("info", "Clearing turtlesim.")


def test_spawn_and_kill(ros: Ros, sim: TurtleSim) -> None:
    assert ros.call(Spawn, "spawn", x=1.0, y=2.0, theta=0.5, name="anna").name == "anna"
    assert ros.call(Spawn, "spawn", x=1.0, y=2.0).name == "turtle2"
    wait_for_graph(ros, {"turtle1", "anna", "turtle2"})
    pose = ros.listen(Pose, "anna/pose")[-1]
    assert (pose.x, pose.y, pose.theta) == (1.0, 2.0, 0.5)
    ros.call(Kill, "kill", name="turtle1")
    ros.call(Kill, "kill", name="anna")
    wait_for_graph(ros, {"turtle2"})
    assert ros.call(Spawn, "spawn", x=9.0, y=9.0, name="anna").name == "anna"
    wait_for_graph(ros, {"anna", "turtle2"})
    pose = wait_until(lambda: (p := ros.listen(Pose, "anna/pose")[-1]).x == 9.0 and p, "new anna")
    assert pose.y == 9.0


@pytest.mark.parametrize("name", ["my turtle!", "1st", "a//b", "/absolute", "~/mine", "{node}", "schön", "n" * 300])
def test_spawn_refuses_what_is_no_ros_name(ros: Ros, name: str) -> None:
    ros.run()
    assert ros.call(Spawn, "spawn", x=1.0, y=2.0, name=name).name == ""
    errors = wait_until(lambda: [text for _, level, text in ros.logged if level == "error"], "error line")
    assert len(errors) == 1
    assert errors[0].startswith(f"Cannot spawn a turtle named [{name}]")
    assert "\n" not in errors[0]
    wait_for_graph(ros, {"turtle1"})


def test_wrong_names_are_answered_and_logged(ros: Ros, sim: TurtleSim) -> None:
    assert ros.call(Spawn, "spawn", name="turtle1").name == ""
    ros.call(Kill, "kill", name="nobody")
    ros.wait_for_log("error", "A turtle named [turtle1] already exists")
    ros.wait_for_log("error", "Tried to kill turtle [nobody], which does not exist")


def test_reset(ros: Ros, sim: TurtleSim) -> None:
    sim.set_parameters([Parameter("background_g", value=0)])
    ros.call(Spawn, "spawn", x=1.0, y=2.0)
    ros.call(TeleportAbsolute, "turtle1/teleport_absolute", x=1.0, y=10.0, theta=1.0)
    poses = ros.listen(Pose, "turtle1/pose")
    wait_until(lambda: poses[-1].x == 1.0, "teleport")
    ros.call(Empty, "reset")
    wait_for_graph(ros, {"turtle1"})
    wait_until(lambda: (poses[-1].x, poses[-1].theta) == (MIDDLE, 0.0), "turtle1 in the middle")
    assert sim.picture().getpixel((100, 200)) == (69, 0, 255)
    ros.wait_for_log("info", "Resetting turtlesim.")
    assert ros.call(Spawn, "spawn", x=1.0, y=2.0).name == "turtle2"


def test_killed_turtle1_is_back_after_a_reset(ros: Ros, sim: TurtleSim) -> None:
    for _ in range(3):
        ros.call(Kill, "kill", name="turtle1")
        ros.call(Empty, "reset")
    wait_for_graph(ros, {"turtle1"})
    poses = ros.listen(Pose, "turtle1/pose")
    ros.publisher().publish(twist(1.0))
    wait_until(lambda: poses[-1].x > MIDDLE, "movement")


def test_many_turtles_come_and_go(ros: Ros, sim: TurtleSim) -> None:
    for _ in range(10):
        names = [ros.call(Spawn, "spawn", x=1.0, y=1.0).name for _ in range(3)]
        for name in names:
            ros.call(Kill, "kill", name=name)
    wait_for_graph(ros, {"turtle1"})
    assert ros.listen(Pose, "turtle1/pose")


# The action


def test_rotation_succeeds_with_feedback_and_result(ros: Ros, sim: TurtleSim) -> None:
    feedback: list[float] = []
    handle = ros.send(ros.rotation_client(), 1.57, feedback)
    assert handle.accepted
    answer = ros.result(handle)
    assert answer.status == GoalStatus.STATUS_SUCCEEDED
    assert answer.result.delta == -1.5520000457763672
    wait_until(lambda: feedback and abs(feedback[-1]) < 0.02, "last feedback")
    assert len(feedback) > 50
    assert feedback == sorted(feedback, reverse=True)
    ros.wait_for_log("info", "Rotation goal completed successfully")


def test_goal_can_be_cancelled(ros: Ros, sim: TurtleSim) -> None:
    feedback: list[float] = []
    handle = ros.send(ros.rotation_client(), 3.0, feedback)
    wait_until(lambda: len(feedback) > 5, "feedback")
    cancelled = ros.wait(handle.cancel_goal_async(), "answer to the cancel request")
    assert len(cancelled.goals_canceling) == 1
    answer = ros.result(handle)
    assert answer.status == GoalStatus.STATUS_CANCELED
    assert -3.0 < answer.result.delta < 0
    ros.wait_for_log("info", "Rotation goal canceled")
    poses = ros.listen(Pose, "turtle1/pose")
    assert poses[-1].angular_velocity == 0.0


def test_velocity_command_aborts_the_goal(ros: Ros, sim: TurtleSim) -> None:
    feedback: list[float] = []
    publisher = ros.publisher()
    handle = ros.send(ros.rotation_client(), 3.0, feedback)
    wait_until(lambda: len(feedback) > 5, "feedback")
    publisher.publish(twist(1.0))
    answer = ros.result(handle)
    assert answer.status == GoalStatus.STATUS_ABORTED
    assert -3.0 < answer.result.delta < 0
    text = "Velocity command received during rotation goal. Aborting goal"
    ros.wait_for_log("warn", text)


def test_new_goal_aborts_the_running_one(ros: Ros, sim: TurtleSim) -> None:
    client = ros.rotation_client()
    first = ros.send(client, 3.0)
    second = ros.send(client, 0.5)
    assert ros.result(first).status == GoalStatus.STATUS_ABORTED
    assert ros.result(second).status == GoalStatus.STATUS_SUCCEEDED
    text = "Rotation goal received before a previous goal finished. Aborting previous goal"
    ros.wait_for_log("warn", text)


def test_goal_that_is_no_number_is_aborted(ros: Ros, sim: TurtleSim) -> None:
    handle = ros.send(ros.rotation_client(), math.nan)
    assert handle.accepted
    assert ros.result(handle).status == GoalStatus.STATUS_ABORTED


@pytest.mark.parametrize("end", ["kill", "reset"])
def test_goal_in_flight_is_aborted_when_its_turtle_goes(ros: Ros, sim: TurtleSim, end: str) -> None:
    client = ros.rotation_client()
    handle = ros.send(client, 3.0)
    early = ros.request(handle.get_result_async)
    if end == "kill":
        ros.call(Kill, "kill", name="turtle1")
    else:
        ros.call(Empty, "reset")
    assert ros.wait(early, "result asked for before").status == GoalStatus.STATUS_ABORTED
    assert ros.result(handle).status == GoalStatus.STATUS_ABORTED  # and asked for afterwards
    if end == "kill":
        wait_for_graph(ros, set())
    else:
        assert ros.result(ros.send(client, 0.5)).status == GoalStatus.STATUS_SUCCEEDED


def test_killed_turtle_rejects_goals_and_takes_them_again_when_spawned(ros: Ros, sim: TurtleSim) -> None:
    client = ros.rotation_client()
    assert ros.result(ros.send(client, 0.1)).status == GoalStatus.STATUS_SUCCEEDED
    ros.call(Kill, "kill", name="turtle1")
    assert not ros.send(client, 1.0).accepted  # its action lingers for a second
    ros.call(Spawn, "spawn", x=1.0, y=1.0, name="turtle1")
    assert ros.result(ros.send(client, 0.5)).status == GoalStatus.STATUS_SUCCEEDED
    wait_for_graph(ros, {"turtle1"})


def test_goals_and_kills_at_full_speed_hurt_nothing(ros: Ros, sim: TurtleSim) -> None:
    client = ros.rotation_client()
    for number in range(15):
        ros.request(client.send_goal_async, RotateAbsolute.Goal(theta=1.0))
        if number % 3:
            ros.call(Empty, "reset")
        else:
            ros.call(Kill, "kill", name="turtle1")
            ros.call(Spawn, "spawn", x=5.0, y=5.0, name="turtle1")
    assert ros.result(ros.send(client, 0.5)).status == GoalStatus.STATUS_SUCCEEDED


def test_destroyed_node_leaves_the_graph_while_a_goal_runs(ros: Ros, sim: TurtleSim) -> None:
    ros.send(ros.rotation_client(), 3.0)
    for _ in range(2):
        assert sim.executor is not None
        wait_until(sim.executor.create_task(sim.destroy_node).done, "end of the node")
    wait_until(lambda: "turtlesim" not in ros.observer.get_node_names(), "end of the node in the graph")


def test_picture_can_be_taken_from_any_thread_while_the_turtle_moves(ros: Ros, sim: TurtleSim) -> None:
    ros.publisher().publish(twist(2.0, turning=1.0))
    pictures: list[Image.Image] = []

    def take() -> None:
        pictures.extend(sim.picture() for _ in range(50))

    threads = [threading.Thread(target=take) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(TIMEOUT)
    assert {(image.size, image.mode) for image in pictures} == {((500, 500), "RGB")}
    assert len(pictures) == 200


# Several simulators


def test_simulators_under_namespaces_do_not_disturb_each_other(ros: Ros) -> None:
    for name in ("robot1", "robot2"):
        ros.run(namespace=name)
    still = ros.listen(Pose, "robot1/turtle1/pose")
    moving = ros.listen(Pose, "robot2/turtle1/pose")
    assert ros.call(Spawn, "robot1/spawn", x=1.0, y=1.0).name == "turtle2"
    assert ros.call(Spawn, "robot2/spawn", x=1.0, y=1.0).name == "turtle2"
    ros.publisher("robot2/turtle1/cmd_vel").publish(twist(1.0))
    wait_until(lambda: moving[-1].x > MIDDLE + 0.2, "movement of robot2")
    count = len(still)
    wait_until(lambda: len(still) > count + 10, "poses of robot1")
    assert {pose.x for pose in still} == {MIDDLE}


# Time


class Ticks:
    """When the world of a simulator ticked, and when its timer planned the next tick: in seconds."""

    def __init__(self, sim: TurtleSim, monkeypatch: pytest.MonkeyPatch) -> None:
        self.times: list[float] = []
        self.planned: list[float] = []
        (self._timer,) = sim.timers
        self.block = 0.0  # seconds that the next tick is to take
        self._tick = sim.world.tick
        monkeypatch.setattr(sim.world, "tick", self._on_tick)

    def _on_tick(self, now: int) -> Any:
        self.times.append(now / 1e9)
        before, left, after = time.monotonic_ns(), self._timer.time_until_next_call(), time.monotonic_ns()
        if after - before < 100_000:  # else the machine was busy in between
            self.planned.append((after + left) / 1e9)
        block, self.block = self.block, 0.0
        time.sleep(block)
        return self._tick(now)


def test_ticks_do_not_drift(ros: Ros, sim: TurtleSim, monkeypatch: pytest.MonkeyPatch) -> None:
    ticks = Ticks(sim, monkeypatch)
    wait_until(lambda: ticks.times and ticks.times[-1] - ticks.times[0] > 5, "five seconds of ticks")
    times = np.array(ticks.times)
    elapsed = times[-1] - times[0]
    assert len(times) <= elapsed / 0.016 + 2  # never more than there is time for
    assert len(times) > 0.5 * elapsed / 0.016  # and not many skipped, however busy the machine is
    # However late a tick comes, the next is planned on the grid of 16 ms where the first one was.
    planned = np.array(ticks.planned) - ticks.planned[0]
    beside = (planned + 0.008) % 0.016 - 0.008
    assert len(planned) > 100
    assert np.abs(beside).max() < 0.0005


def test_no_burst_after_a_stall(ros: Ros, sim: TurtleSim, monkeypatch: pytest.MonkeyPatch) -> None:
    ticks = Ticks(sim, monkeypatch)
    wait_until(lambda: len(ticks.times) > 10, "ticks")
    ticks.block = 1.0
    wait_until(lambda: ticks.times[-1] - ticks.times[0] > 1.5, "ticks after the stall")
    times = np.array(ticks.times)
    stall = int(np.argmax(np.diff(times)))
    assert np.diff(times)[stall] >= 1.0
    after = times[stall + 1 :] - times[stall + 1]
    assert (after < 0.1).sum() <= 0.1 / 0.016 + 2
    assert len(times) <= (times[-1] - times[0] - 1.0) / 0.016 + 4


@pytest.mark.parametrize("executor", list(EXECUTORS))
def test_one_that_keeps_up_makes_up_for_a_stall(ros: Ros, monkeypatch: pytest.MonkeyPatch, executor: str) -> None:
    sim = ros.run(executor, keeps_up=True)
    ticks = Ticks(sim, monkeypatch)
    wait_until(lambda: len(ticks.times) > 10, "ticks")
    ticks.block = 1.0
    wait_until(lambda: ticks.times[-1] - ticks.times[0] > 1.5, "ticks after the stall")
    times = np.array(ticks.times[: len(ticks.times)])
    assert abs(len(times) - (times[-1] - times[0]) / 0.016) <= 4
    assert np.diff(times).max() < 0.1  # each as of the time when it was due


# As a process of its own


@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM])
def test_as_a_process(ros: Ros, end: signal.Signals) -> None:
    command = [sys.executable, "-m", "course_kit.robots.turtlesim", "--ros-args"]
    command += ["-r", "__ns:=/robot1", "-p", "background_r:=0"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    try:
        poses = ros.listen(Pose, "/robot1/turtle1/pose")
        ros.publisher("/robot1/turtle1/cmd_vel").publish(twist(2.0))
        wait_until(lambda: poses[-1].x > MIDDLE + 0.5, "movement")
        client = ros.rotation_client("/robot1/turtle1")
        assert ros.result(ros.send(client, -1.57)).status == GoalStatus.STATUS_SUCCEEDED
        parameters = AsyncParameterClient(ros.observer, "/robot1/turtlesim")
        values = ros.wait(parameters.get_parameters(["background_r"]), "parameter").values
        assert values[0].integer_value == 0
        ros.send(client, 1.57)  # ends while a goal runs
        process.send_signal(end)
        _, printed = process.communicate(timeout=TIMEOUT)
    finally:
        process.kill()
    assert process.returncode == 0
    assert "Traceback" not in printed
    assert "Starting turtlesim with node name /robot1/turtlesim" in printed
    assert "ERROR" not in printed


@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM])
def test_signal_during_the_start_ends_the_process_cleanly(end: signal.Signals) -> None:
    command = [sys.executable, "-m", "course_kit.robots.turtlesim"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    assert process.stderr is not None
    try:
        printed = process.stderr.readline()
        assert "Starting turtlesim" in printed
        process.send_signal(end)
        printed += process.communicate(timeout=TIMEOUT)[1]
    finally:
        process.kill()
    assert process.returncode == 0
    assert "Traceback" not in printed


@pytest.mark.parametrize("arguments", [["-p", "background_r:=300"], ["-p", "background_r:=red"], ["-r", "nonsense"]])
def test_wrong_arguments_end_the_process_with_one_line(arguments: list[str]) -> None:
    command = [sys.executable, "-m", "course_kit.robots.turtlesim", "--ros-args", *arguments]
    done = subprocess.run(command, stderr=subprocess.PIPE, text=True, timeout=60)
    assert done.returncode == 1
    assert "Traceback" not in done.stderr
    assert done.stderr.splitlines()[-1].startswith("turtlesim cannot start: ")
