"""Transforms on their way: broadcasters, listeners, /tf and /tf_static, other processes, simulated time.

As tf2_ros it imports course_kit.robots.tf.broadcasters, course_kit.robots.tf.buffer and course_kit.robots.tf.listener.
"""

from __future__ import annotations

import gc
import subprocess
import sys
import time as clocks
from collections.abc import Iterator
from typing import Any

import pytest
import rclpy
from ament_index_python.packages import get_package_share_directory
from rcl_interfaces.msg import Log
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.duration import Duration
from rclpy.executors import Executor, MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, ReliabilityPolicy
from rclpy.time import Time
from rosgraph_msgs.msg import Clock
from tf2_msgs.srv import FrameGraph
from tf2_ros import Buffer, StaticTransformBroadcaster, TransformBroadcaster, TransformException, TransformListener

from course_kit.ros.private_api.rclpy_parts import fast_executor
from course_kit.ros.spinning import context
from tests.ros2_command import end
from tests.transforms import at, place
from tests.waiting import wait_until

pytestmark = pytest.mark.usefixtures("fresh_domain")
LATEST = Time()

ROBOT = """
import sys
import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from tf2_ros import StaticTransformBroadcaster, TransformBroadcaster

class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.moving, self.fixed = TransformBroadcaster(self), StaticTransformBroadcaster(self)
        self.fixed.sendTransform(self.link("laser", "base_link", 0.1))
        self.fixed.sendTransform([self.link("camera", "base_link", 0.2)])
        self.create_timer(0.02, self.tick)

    def link(self, child, parent, x):
        message = TransformStamped(child_frame_id=child)
        message.header.frame_id = parent
        message.header.stamp = self.get_clock().now().to_msg()
        message.transform.translation.x = x
        message.transform.rotation.w = 1.0
        return message

    def tick(self):
        self.moving.sendTransform([self.link("base_link", "odom", 1.0), self.link("odom", "map", 10.0)])

rclpy.init()
robot = Robot()
print("ready", flush=True)
try:
    rclpy.spin(robot)
except KeyboardInterrupt:
    pass
robot.destroy_node()
rclpy.try_shutdown()
"""


class Stage:
    """Nodes in one executor, spun by the test."""

    def __init__(self) -> None:
        context.start()
        self.executor: Executor = SingleThreadedExecutor()
        self.nodes: list[Node] = []

    def node(self, name: str, **options: Any) -> Node:
        node = Node(name, **options)
        self.nodes.append(node)
        self.executor.add_node(node)
        return node

    def until(self, condition: Any, what: str = "") -> Any:
        return wait_until(condition, what, pause=lambda seconds: self.executor.spin_once(timeout_sec=seconds))

    def end(self) -> None:
        self.executor.shutdown(timeout_sec=0)
        for node in self.nodes:
            node.destroy_node()


def logged_by(node: Node, listening: Node) -> list[str]:
    """What a node logs from now on, as another one hears it."""
    lines: list[str] = []

    def hear(message: Log) -> None:
        if message.name == node.get_name():
            lines.append(message.msg)

    listening.create_subscription(Log, "/rosout", hear, 1000)
    return lines


@pytest.fixture
def stage(fresh_domain: None) -> Iterator[Stage]:
    stage = Stage()
    yield stage
    stage.end()


@pytest.fixture
def robot(fresh_domain: None) -> Iterator[None]:
    with subprocess.Popen([sys.executable, "-c", ROBOT], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None and process.stdout.readline() == "ready\n"
        yield
        end(process)


def test_what_a_node_broadcasts_another_looks_up(stage: Stage) -> None:
    broadcaster = TransformBroadcaster(stage.node("robot"))
    buffer = Buffer()
    TransformListener(buffer, stage.node("planner"))

    def sent() -> bool:
        broadcaster.sendTransform([at("base_link", "odom", 1.0, x=2.0), at("odom", "map", 1.0, y=3.0)])
        return bool(buffer.can_transform("map", "base_link", LATEST))

    stage.until(sent)
    assert place(buffer.lookup_transform("map", "base_link", LATEST)) == pytest.approx((2.0, 3.0, 0.0))
    broadcaster.sendTransform(at("base_link", "odom", 2.0, x=4.0))
    stage.until(lambda: buffer.can_transform("odom", "base_link", Time(seconds=1.5)))
    assert place(buffer.lookup_transform("odom", "base_link", Time(seconds=1.5)))[0] == pytest.approx(3.0)


@pytest.mark.parametrize("is_fast", [False, True])
def test_a_listener_takes_all_that_waits_in_one_turn(stage: Stage, is_fast: bool) -> None:
    if is_fast:
        stage.executor.shutdown()
        stage.executor = fast_executor(rclpy.get_default_context())
    broadcaster = TransformBroadcaster(stage.node("robot"))
    buffer = Buffer()
    kept = TransformListener(buffer, stage.node("planner"))
    stage.until(lambda: broadcaster.pub_tf.get_subscription_count() == 1)
    for tenth in range(60):
        broadcaster.sendTransform(at("base_link", "odom", tenth / 10, x=float(tenth)))
    assert broadcaster.pub_tf.wait_for_all_acked(Duration(seconds=20))
    stage.until(lambda: buffer.can_transform("odom", "base_link", LATEST))
    turns = 0
    while place(buffer.lookup_transform("odom", "base_link", LATEST))[0] < 59 and turns < 30:
        stage.executor.spin_once(timeout_sec=0.1)
        turns += 1
    assert turns < 30
    assert place(buffer.lookup_transform("odom", "base_link", Time(seconds=2)))[0] == pytest.approx(20)
    kept.unregister()


def test_who_comes_late_gets_all_that_is_static(stage: Stage) -> None:
    broadcaster = StaticTransformBroadcaster(stage.node("robot"))
    broadcaster.sendTransform(at("laser", "base_link", 0.0, x=0.1))
    broadcaster.sendTransform((at("camera", "base_link", 0.0, x=0.2), at("lens", "camera", 0.0, x=0.3)))
    broadcaster.sendTransform(at("laser", "base_link", 0.0, x=0.5))  # put right
    buffer = Buffer()
    TransformListener(buffer, stage.node("planner"))
    stage.until(lambda: buffer.can_transform("laser", "lens", LATEST))
    assert place(buffer.lookup_transform("laser", "lens", Time(seconds=99)))[0] == pytest.approx(0.0)


def test_topics_have_the_qos_of_tf2(stage: Stage) -> None:
    node = stage.node("robot")
    kept = TransformBroadcaster(node), StaticTransformBroadcaster(node), TransformListener(Buffer(), node)
    for topic, durability in (("/tf", DurabilityPolicy.VOLATILE), ("/tf_static", DurabilityPolicy.TRANSIENT_LOCAL)):
        for ends in (node.get_publishers_info_by_topic, node.get_subscriptions_info_by_topic):
            (end,) = ends(topic)
            assert end.topic_type == "tf2_msgs/msg/TFMessage"
            assert (end.qos_profile.durability, end.qos_profile.reliability) == (
                durability,
                ReliabilityPolicy.RELIABLE,
            )
    assert kept[2].buffer.all_frames_as_yaml() == "[]"


def test_another_process_is_heard(robot: None, stage: Stage) -> None:
    buffer = Buffer()
    TransformListener(buffer, stage.node("planner"))
    stage.until(lambda: buffer.can_transform("map", "camera", LATEST) and buffer.can_transform("map", "laser", LATEST))
    assert place(buffer.lookup_transform("map", "laser", LATEST))[0] == pytest.approx(11.1)
    now = rclpy.clock.Clock().now()
    stage.until(lambda: buffer.can_transform("map", "camera", now), "a transform for a moment that is then past")
    assert place(buffer.lookup_transform("map", "camera", now))[0] == pytest.approx(11.2)


@pytest.mark.parametrize("listening", ["beside it", "in a thread of its own", "with more threads"])
def test_a_callback_waits_in_vain_unless_the_listener_can_hear_meanwhile(
    robot: None, stage: Stage, listening: str
) -> None:
    if listening == "with more threads":
        stage.executor.shutdown()
        stage.executor = MultiThreadedExecutor(2)
    node = stage.node("planner")
    said: list[Any] = []
    buffer = Buffer()
    in_vain, apart = listening == "beside it", listening == "in a thread of its own"
    listener = TransformListener(buffer, stage.node("ears") if apart else node, spin_thread=apart)

    def tick() -> None:
        # When the robot is heard: no moment before that will ever be there, and now is not there yet.
        if not said and buffer.can_transform("map", "laser", LATEST):
            try:
                now = node.get_clock().now()
                said.append(buffer.lookup_transform("map", "laser", now, Duration(seconds=0.3 if in_vain else 20)))
            except TransformException as error:
                said.append(error)

    node.create_timer(0.01, tick, callback_group=MutuallyExclusiveCallbackGroup())
    stage.until(lambda: said)
    assert isinstance(said[0], TransformException) is in_vain
    listener.unregister()


def test_a_callback_awaits_a_transform_and_blocks_nothing(robot: None, stage: Stage) -> None:
    node = stage.node("planner")
    buffer = Buffer()
    TransformListener(buffer, node)
    said: list[Any] = []

    async def tick() -> None:
        if not buffer.can_transform("map", "laser", LATEST):
            return
        timer.cancel()
        said.append(await buffer.lookup_transform_async("map", "laser", node.get_clock().now()))

    timer = node.create_timer(0.01, tick)
    stage.until(lambda: said)
    assert place(said[0])[0] == pytest.approx(11.1)


def test_a_thread_of_a_listener_ends_with_it_and_with_its_node(stage: Stage) -> None:
    node, other = Node("planner"), Node("other")
    listeners = [TransformListener(Buffer(), one, spin_thread=True) for one in (node, other)]
    threads = [one.dedicated_listener_thread for one in listeners]
    assert all(one.is_alive() and one.daemon for one in threads)
    listeners[0].unregister()
    other.destroy_node()
    wait_until(lambda: not any(one.is_alive() for one in threads))
    node.destroy_node()


def test_a_jump_back_of_simulated_time_clears_the_buffer(stage: Stage) -> None:
    node = stage.node("planner", parameter_overrides=[Parameter("use_sim_time", value=True)])
    simulator = stage.node("simulator")
    clock = simulator.create_publisher(Clock, "/clock", 10)
    said = logged_by(node, simulator)
    for _ in range(20):  # the clock of a node that lives on shall not call them
        node.destroy_service(Buffer(node=node).srv)
    gc.collect()
    buffer = Buffer(node=node)

    def at_time(seconds: float) -> bool:
        clock.publish(Clock(clock=Time(nanoseconds=round(seconds * 1e9)).to_msg()))
        return node.get_clock().now().nanoseconds == round(seconds * 1e9)

    stage.until(lambda: at_time(100.0))
    buffer.set_transform(at("base_link", "odom", 99.0), "test")
    buffer.set_transform_static(at("laser", "base_link", 0.0), "test")
    stage.until(lambda: at_time(101.0))
    assert buffer.can_transform("odom", "base_link", LATEST)
    stage.until(lambda: at_time(5.0))
    assert not buffer.can_transform("odom", "base_link", LATEST)
    assert buffer.can_transform("base_link", "laser", LATEST)
    stage.until(lambda: said)
    assert said == ["Detected jump back in time. Clearing tf buffer."]
    buffer.set_transform(at("base_link", "odom", 4.0), "test")
    assert buffer.can_transform("odom", "base_link", LATEST)


def test_what_a_buffer_refuses_its_listener_logs(stage: Stage) -> None:
    broadcaster = TransformBroadcaster(stage.node("robot"))
    planner = stage.node("planner")
    said = logged_by(planner, stage.node("log"))
    TransformListener(Buffer(), planner)

    def sent(*frames: Any) -> bool:
        broadcaster.sendTransform(frames)
        return bool(said)

    stage.until(lambda: sent(at("base_link", "base_link", 1.0)))
    assert said[0].startswith('TF_SELF_TRANSFORM: Ignoring transform from authority "default_authority"')
    said.clear()
    stage.until(lambda: sent(at("base_link", "odom", 100.0), at("base_link", "odom", 50.0)))
    stage.until(lambda: any(line.startswith("TF_OLD_DATA ignoring data from the past") for line in said))


def test_a_node_offers_its_frames(stage: Stage) -> None:
    node, asking = stage.node("planner"), stage.node("asking")
    buffer = Buffer(node=node)
    buffer.set_transform(at("base_link", "odom", 1.0), "test")
    client = asking.create_client(FrameGraph, "tf2_frames")
    stage.until(client.service_is_ready)
    answer = client.call_async(FrameGraph.Request())
    stage.until(answer.done)
    assert answer.result().frame_yaml == buffer.all_frames_as_yaml()


PACKAGES = ("tf2_msgs", "tf2_py", "tf2_ros", "tf2_ros_py", "tf2_geometry_msgs", "tf2_sensor_msgs")


@pytest.mark.parametrize("name", PACKAGES)
def test_the_packages_are_in_the_index(name: str) -> None:
    with open(f"{get_package_share_directory(name)}/package.xml") as file:
        assert f"<name>{name}</name>" in file.read()


def test_what_is_handed_over_wrongly_is_told(stage: Stage) -> None:
    node, wrong = stage.node("robot"), at("base_link", "odom", 1.0).transform
    for broadcaster in (TransformBroadcaster(node), StaticTransformBroadcaster(node)):
        for given in (wrong, [wrong]):
            with pytest.raises(TypeError, match=r"takes a TransformStamped or a list of them, not Transform$"):
                broadcaster.sendTransform(given)
    buffer: Any = Buffer()
    with pytest.raises(TypeError, match="takes the buffer first"):
        TransformListener(node, buffer)  # type: ignore[arg-type]


def test_a_wait_goes_by_the_clock_on_the_wall(stage: Stage) -> None:
    node = stage.node("planner", parameter_overrides=[Parameter("use_sim_time", value=True)])
    began = clocks.monotonic()
    assert not Buffer(node=node).can_transform("odom", "base_link", LATEST, Duration(seconds=0.1))
    assert clocks.monotonic() - began >= 0.1
