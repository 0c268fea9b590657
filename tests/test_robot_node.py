"""The node robot as other nodes and other processes see it: topics, frames, time, commands, bumps, its end."""

from __future__ import annotations

import math
import signal
import subprocess
import time
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import TransformStamped, Twist, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.clock import Clock as RealClock
from rclpy.clock import ClockType
from rclpy.duration import Duration
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy, qos_profile_sensor_data
from rclpy.time import Time
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, JointState, LaserScan
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage
from tf2_ros import Buffer, TransformBroadcaster, TransformListener

from course_kit import run, stop
from course_kit.robots.robot import shape, sharing
from course_kit.robots.robot.node import CLOCK_BREAK, Robot
from course_kit.robots.robot.simulation import TICK_NS
from course_kit.robots.robot.world import Wall, World
from course_kit.ros import packages
from course_kit.ros.interface_types import type_name
from tests.waiting import wait_until

pytestmark = [
    pytest.mark.usefixtures("fresh_domain"),
    pytest.mark.by_turns("many nodes and programs"),
]

BOX = World(
    "box",
    (Wall(0, 1.5, 4, 0.1), Wall(0, -1.5, 4, 0.1), Wall(2, 0, 3, 0.1, math.pi / 2), Wall(-2, 0, 3, 0.1, math.pi / 2)),
    (),
    (0.0, 0.0, 0.0),
    (),
)
SAMPLE = 50_000_000  # ns of simulated time from one sample of the wheels to the next
LATCHED = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
BEST_EFFORT, RELIABLE = ReliabilityPolicy.BEST_EFFORT, ReliabilityPolicy.RELIABLE
VOLATILE, TRANSIENT_LOCAL = DurabilityPolicy.VOLATILE, DurabilityPolicy.TRANSIENT_LOCAL
TOPICS = {
    "/odom": (Odometry, RELIABLE, VOLATILE),
    "/scan": (LaserScan, BEST_EFFORT, VOLATILE),
    "/imu": (Imu, RELIABLE, VOLATILE),
    "/joint_states": (JointState, RELIABLE, VOLATILE),
    "/tf": (TFMessage, RELIABLE, VOLATILE),
    "/tf_static": (TFMessage, RELIABLE, TRANSIENT_LOCAL),
    "/clock": (Clock, RELIABLE, VOLATILE),
    "/robot_description": (String, RELIABLE, TRANSIENT_LOCAL),
    "/bumper": (String, RELIABLE, TRANSIENT_LOCAL),
}


class Observer(Node):
    """Hears topics, and sends a command ten times a second of the robot's time."""

    def __init__(self) -> None:
        super().__init__("observer", parameter_overrides=[Parameter("use_sim_time", value=True)])
        self.command: Any = None
        self.ticked: list[int] = []  # when its timer was called, ns of simulated time
        self.create_timer(0.1, self.tick)
        self.senders: dict[Any, Any] = {}

    def hear(self, kind: Any, topic: str, qos: Any = 1000) -> list[Any]:
        """A list that grows by what comes."""
        heard: list[Any] = []
        self.create_subscription(kind, topic, heard.append, qos)
        return heard

    def drive(self, linear: float, angular: float = 0.0, kind: Any = TwistStamped, topic: str = "/cmd_vel") -> None:
        """Command this from now on."""
        key = kind, topic
        sender = self.senders.get(key)
        if sender is None:
            sender = self.senders[key] = self.create_publisher(kind, topic, 10)
            wait_until(sender.get_subscription_count, f"a subscription of {topic}")
        self.command = sender, command(linear, angular, kind)

    def tick(self) -> None:
        self.ticked.append(self.get_clock().now().nanoseconds)
        if self.command is not None:
            sender, message = self.command
            sender.publish(message)


def command(linear: float, angular: float, kind: Any = TwistStamped) -> Any:
    message = kind()
    twist = message.twist if kind is TwistStamped else message
    twist.linear.x, twist.angular.z = linear, angular
    return message


def nanoseconds(stamp: Any) -> int:
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)


def robot_in_box(**options: Any) -> Robot:
    return run(Robot, **{"world": BOX, "factor": 5.0, **options})


@pytest.fixture
def observer() -> Iterator[Observer]:
    yield run(Observer)
    stop()
    assert not sharing._running


# What is in the graph


def test_topics_types_and_qos(observer: Observer) -> None:
    robot_in_box()
    for topic, (kind, reliability, durability) in TOPICS.items():
        infos = wait_until(partial(observer.get_publishers_info_by_topic, topic), f"a publisher of {topic}")
        seen = [
            (one.node_name, one.topic_type, one.qos_profile.reliability, one.qos_profile.durability) for one in infos
        ]
        assert seen == [("robot", type_name(kind), reliability, durability)]
    (info,) = wait_until(lambda: observer.get_subscriptions_info_by_topic("/cmd_vel"))
    assert (info.topic_type, info.qos_profile.reliability) == ("geometry_msgs/msg/TwistStamped", RELIABLE)


def test_parameters_are_described_and_cannot_be_changed(observer: Observer) -> None:
    robot = robot_in_box()
    for name in ("world", "seed", "start", "factor", "enable_stamped_cmd_vel", "cmd_vel_timeout", "frame_prefix"):
        descriptor = robot.describe_parameter(name)
        assert descriptor.description
        assert descriptor.read_only
    assert robot.get_parameter("factor").value == 5.0
    assert not robot.set_parameters([Parameter("factor", value=1.0)])[0].successful


# What it measures


def test_samples_come_at_their_rates_and_with_one_stamp(observer: Observer) -> None:
    heard = {
        topic: observer.hear(kind, topic)
        for topic, kind in (("/odom", Odometry), ("/joint_states", JointState), ("/imu", Imu))
    }
    scans = observer.hear(LaserScan, "/scan", qos_profile_sensor_data)
    robot_in_box()
    wait_until(lambda: len(scans) > 5 and all(len(messages) > 20 for messages in heard.values()), "samples")
    for messages in heard.values():
        stamps = [nanoseconds(one.header.stamp) for one in list(messages)]
        assert {stamp % SAMPLE for stamp in stamps} == {0}
        assert min(np.diff(stamps)) == SAMPLE
    stamps = [nanoseconds(one.header.stamp) for one in list(scans)]
    assert {stamp % (4 * SAMPLE) for stamp in stamps} == {0}
    assert min(np.diff(stamps)) == 4 * SAMPLE  # 5 Hz


def test_frames_and_covariances(observer: Observer) -> None:
    odometry, imu = observer.hear(Odometry, "/odom"), observer.hear(Imu, "/imu")
    joints, scans = (
        observer.hear(JointState, "/joint_states"),
        observer.hear(LaserScan, "/scan", qos_profile_sensor_data),
    )
    robot_in_box()
    wait_until(lambda: odometry and imu and joints and scans)
    frames = [one[0].header.frame_id for one in (odometry, imu, joints, scans)]
    assert frames == ["odom", "imu_link", "base_link", "base_scan"]
    assert odometry[0].child_frame_id == "base_link"
    assert np.diag(odometry[0].pose.covariance.reshape(6, 6)).tolist() == [0.001] * 5 + [0.01]
    assert np.diag(imu[0].linear_acceleration_covariance.reshape(3, 3)).tolist() == [0.017**2] * 3
    assert imu[0].linear_acceleration.z == pytest.approx(9.81, abs=0.2)
    assert joints[0].name == ["wheel_left_joint", "wheel_right_joint"]


def test_the_scan_sees_the_walls_with_noise_and_inf_out_of_reach(observer: Observer) -> None:
    scans = observer.hear(LaserScan, "/scan", qos_profile_sensor_data)
    wide = World(
        "wide", (*BOX.walls[:2], Wall(6, 0, 3, 0.1, math.pi / 2), Wall(-6, 0, 3, 0.1, math.pi / 2)), (), BOX.start, ()
    )
    robot_in_box(world=wide, parameter_overrides=[Parameter("scan_noise", value=0.005)])
    wait_until(lambda: len(scans) > 5)
    scan = scans[-1]
    assert len(scan.ranges) == shape.RAYS
    assert scan.angle_min == 0.0
    assert scan.angle_max == pytest.approx(scan.angle_increment * (shape.RAYS - 1))
    assert scan.ranges[90] == pytest.approx(1.45, abs=0.03)  # six times the noise
    assert scan.ranges[270] == pytest.approx(1.45, abs=0.03)
    assert scan.ranges[0] == math.inf
    assert np.std([one.ranges[90] for one in scans]) > 0.0


def test_the_frames_of_tf_are_those_of_the_description(observer: Observer) -> None:
    moving, fixed = observer.hear(TFMessage, "/tf"), observer.hear(TFMessage, "/tf_static", LATCHED)
    texts = observer.hear(String, "/robot_description", LATCHED)
    robot_in_box()
    wait_until(lambda: moving and fixed and texts)
    transforms = {one.child_frame_id: one for message in (moving[0], fixed[0]) for one in message.transforms}
    assert transforms["base_link"].header.frame_id == "odom"
    for joint in ElementTree.fromstring(texts[0].data).iter("joint"):
        child, origin = joint.find("child"), joint.find("origin")
        assert child is not None
        assert origin is not None
        transform = transforms[child.attrib["link"]]
        assert transform.header.frame_id == "base_link"
        told = transform.transform.translation
        assert [told.x, told.y, told.z] == pytest.approx(list(map(float, origin.attrib["xyz"].split())), abs=1e-5)
    assert transforms.keys() - {"base_link"} == {
        "base_footprint", "base_scan", "imu_link", "wheel_left_link", "wheel_right_link"
    }  # fmt: skip


def test_tf2_knows_where_the_laser_was_when_it_measured(observer: Observer) -> None:
    buffer = Buffer()
    listener = TransformListener(buffer, observer)
    scans = observer.hear(LaserScan, "/scan", qos_profile_sensor_data)
    robot_in_box()

    def stamps() -> list[Time]:  # the first scan may have come before the first transform
        heard = [Time.from_msg(one.header.stamp) for one in list(scans)]
        return [stamp for stamp in heard if buffer.can_transform("odom", "base_scan", stamp)]

    stamp = wait_until(stamps, "the transform at the stamp of a scan")[-1]
    where = buffer.lookup_transform("odom", "base_scan", stamp).transform.translation
    x, y, z = shape.LASER
    assert [where.x, where.y, where.z] == pytest.approx([x, y, z + shape.BASE_HEIGHT], abs=0.001)
    listener.unregister()


# Commands


@pytest.mark.parametrize("kind", [TwistStamped, Twist])
def test_it_drives(observer: Observer, kind: Any) -> None:
    odometry, moving = observer.hear(Odometry, "/odom"), observer.hear(TFMessage, "/tf")
    robot = robot_in_box(parameter_overrides=[Parameter("enable_stamped_cmd_vel", value=kind is TwistStamped)])
    observer.drive(0.2, 0.3, kind)
    wait_until(lambda: odometry and odometry[-1].pose.pose.position.x > 0.3, "the robot to come along")
    x, _, heading = robot.simulation.true_place()
    assert x > 0.25
    assert heading > 0.2
    stamp = moving[-1].transforms[0].header.stamp
    same = wait_until(lambda: [one for one in odometry if one.header.stamp == stamp], "the odometry of that moment")
    pose, transform = same[0].pose.pose, moving[-1].transforms[0].transform
    if moving[-1].transforms[0].header.stamp == stamp:
        assert (transform.translation.x, transform.rotation.z) == (pose.position.x, pose.orientation.z)


def test_one_command_takes_it_not_far(observer: Observer) -> None:
    robot = robot_in_box()
    sender = observer.create_publisher(TwistStamped, "/cmd_vel", 10)
    wait_until(sender.get_subscription_count)
    sender.publish(command(0.2, 0.0))
    wait_until(lambda: robot.vehicle.watchdog_stops == 1, "the watchdog")
    after = robot.simulation.time + 0.5
    wait_until(lambda: robot.simulation.time > after)
    assert robot.simulation.true_twist()[0] == pytest.approx(0.0, abs=0.005)
    assert 0.05 < robot.simulation.true_place()[0] < 0.16  # 0.5 s, and what it takes to stop


def test_commands_that_are_no_numbers_are_ignored(observer: Observer) -> None:
    robot = robot_in_box()
    observer.drive(math.nan)
    wait_until(lambda: len(observer.ticked) > 5)
    observer.drive(0.2)
    wait_until(lambda: robot.simulation.true_place()[0] > 0.1)


def test_it_bumps_into_a_wall_and_says_so(observer: Observer) -> None:
    told = observer.hear(String, "/bumper", LATCHED)
    robot = robot_in_box(start=(1.6, 0.0, 0.0))
    observer.drive(0.2)
    wait_until(lambda: told and told[-1].data == "wall", "a bump")
    observer.drive(-0.2)
    wait_until(lambda: told[-1].data == "", "the end of the bump")
    assert [one.data for one in told] == ["", "wall", ""]
    (bump,) = robot.simulation.collisions()
    assert bump.what == "wall"


# Time


@pytest.mark.parametrize("factor", [1.0, 5.0, 0.0])
def test_nodes_follow_its_time(observer: Observer, factor: float) -> None:
    clocks = observer.hear(Clock, "/clock")
    robot = robot_in_box(factor=factor)
    wait_until(lambda: clocks, "/clock")
    began, simulated = time.monotonic(), robot.simulation.time
    wait_until(lambda: robot.simulation.time > simulated + 2, "two seconds of simulated time")
    gone, passed = robot.simulation.time - simulated, time.monotonic() - began
    if factor:  # it does not run ahead; what it makes up for is at most half a second
        assert gone < (passed + 0.6) * factor
    wait_until(lambda: observer.get_clock().now().nanoseconds > 2e9, "the observer's clock")
    assert {nanoseconds(one.clock) % TICK_NS for one in list(clocks)} == {0}
    wait_until(lambda: len(observer.ticked) > 5, "the observer's timer")
    ahead = observer.get_clock().now().nanoseconds
    assert ahead <= robot.simulation.nanoseconds


def test_a_fast_world_tells_its_time_no_oftener_than_is_of_use(observer: Observer) -> None:
    """Each message wakes every node that follows the clock: at this factor 800 a second would come."""
    clocks, began = observer.hear(Clock, "/clock"), time.monotonic()
    robot_in_box(factor=8.0)
    wait_until(lambda: len(clocks) > 200, "/clock")
    assert len(clocks) <= 1 + (time.monotonic() - began) / CLOCK_BREAK


def test_where_the_robot_is_now_is_often_unknown_in_a_fast_world(observer: Observer) -> None:
    """Chapter 7 says so of a timer that asks tf for now: the newest transform is older than that."""
    buffer, answers = Buffer(), list[bool]()
    listener = TransformListener(buffer, observer)
    robot_in_box(factor=8.0, parameter_overrides=[Parameter("patience", value=10.0)])
    wait_until(lambda: buffer.can_transform("odom", "base_scan", Time()), "the first transform")

    def ask() -> None:
        answers.append(buffer.can_transform("odom", "base_scan", observer.get_clock().now()))

    observer.create_timer(0.03, ask)
    wait_until(lambda: len(answers) >= 400, "400 answers")
    # 0.58 on a quiet machine, 0.48 beside seven busy processes; 0.05 where a callback for scans asks.
    assert answers.count(False) > len(answers) / 4
    listener.unregister()


def test_with_patience_a_loop_keeps_up_with_the_fastest_time(observer: Observer) -> None:
    robot = robot_in_box(factor=0.0, parameter_overrides=[Parameter("patience", value=10.0)])
    observer.drive(0.1, 1.0)
    wait_until(lambda: robot.simulation.true_twist()[0] > 0.05, "the first command")
    after = robot.simulation.time + 5
    wait_until(lambda: robot.simulation.time > after, "five seconds of simulated time", 60)
    assert robot.vehicle.watchdog_stops == 0


class Corrector(Node):
    """Tells where odom lies in map, ten times a second of real time, as of so many simulated seconds ago."""

    def __init__(self, lag: float) -> None:
        super().__init__("corrector", parameter_overrides=[Parameter("use_sim_time", value=True)])
        self.lag = lag
        self.broadcaster = TransformBroadcaster(self)
        self.create_timer(0.1, self.tell, clock=RealClock(clock_type=ClockType.STEADY_TIME))

    def tell(self) -> None:
        stamp = self.get_clock().now() - Duration(seconds=self.lag)
        transform = TransformStamped(child_frame_id="odom")
        transform.header.frame_id, transform.header.stamp = "map", stamp.to_msg()
        self.broadcaster.sendTransform(transform)


@pytest.mark.usefixtures("observer")
def test_with_patience_time_waits_for_who_corrects_odometry() -> None:
    corrector = run(Corrector, lag=2.0)
    robot = robot_in_box(factor=8.0, parameter_overrides=[Parameter("patience", value=10.0)])
    simulation = robot.simulation
    wait_until(lambda: robot.vehicle.slows(simulation.time), "slow time")
    began, simulated = time.monotonic(), simulation.time
    wait_until(lambda: simulation.time > simulated + 1.5, "1.5 s of simulated time")
    assert time.monotonic() - began > 1.2
    corrector.lag = -2.0
    wait_until(lambda: not robot.vehicle.slows(simulation.time), "time as before")


# Several robots


def test_two_robots_in_one_world(observer: Observer) -> None:
    scans = observer.hear(LaserScan, "/scan", qos_profile_sensor_data)
    other = observer.hear(Odometry, "/robot2/odom")
    first = robot_in_box()
    second = run(Robot, world=BOX, namespace="/robot2")
    assert second.simulation is first.simulation
    wait_until(lambda: other and any(one.ranges[90] < 0.4 for one in scans), "the second robot, to the first's left")
    assert (other[0].header.frame_id, other[0].child_frame_id) == ("robot2/odom", "robot2/base_link")
    observer.drive(0.2, topic="/robot2/cmd_vel")
    wait_until(lambda: second.simulation.true_place(second.vehicle.number)[0] > 0.2)
    assert first.simulation.true_place(first.vehicle.number)[0] == pytest.approx(0.0, abs=0.01)
    assert len(wait_until(lambda: observer.get_publishers_info_by_topic("/clock"))) == 1
    assert {one.number for one in first.simulation.vehicles()} == {0, 1}


def test_when_the_first_ends_time_goes_on(observer: Observer) -> None:
    clocks = observer.hear(Clock, "/clock")
    first = robot_in_box()
    second = run(Robot, world=BOX, namespace="/robot2")
    wait_until(lambda: len(clocks) > 10)
    stop(first)
    before = len(clocks)
    wait_until(lambda: len(clocks) > before + 50, "time after the first robot's end")
    stamps = [nanoseconds(one.clock) for one in list(clocks)]
    assert min(np.diff(stamps)) > 0
    assert [one.number for one in second.simulation.vehicles()] == [second.vehicle.number]


# Again, and the end


def scans_of(observer: Observer, seed: int) -> dict[int, list[float]]:
    """The first scans of a run, by their stamps."""
    scans = observer.hear(LaserScan, "/scan", qos_profile_sensor_data)
    robot = run(Robot, world="rooms", seed=seed, factor=5.0)
    wait_until(lambda: scans and nanoseconds(scans[-1].header.stamp) > 6e9, "6 s of scans")
    stop(robot)
    return {nanoseconds(one.header.stamp): list(one.ranges) for one in scans}


def test_the_same_seed_gives_the_same_run(observer: Observer) -> None:
    one, same, other = (scans_of(observer, seed) for seed in (1, 1, 2))
    common = one.keys() & same.keys()
    assert len(common) > 5
    assert all(one[stamp] == same[stamp] for stamp in common)
    assert all(one[stamp] != other[stamp] for stamp in one.keys() & other.keys())


def test_a_cell_that_is_run_again_begins_anew(observer: Observer) -> None:
    before = robot_in_box()
    wait_until(lambda: before.simulation.time > 0.5)
    robot = robot_in_box()
    assert robot.simulation is not before.simulation
    assert robot.vehicle.number == 0
    wait_until(lambda: len(observer.get_publishers_info_by_topic("/odom")) == 1, "one robot in the graph")


@pytest.mark.parametrize("executor", [SingleThreadedExecutor, MultiThreadedExecutor])
def test_any_executor(observer: Observer, executor: Any) -> None:
    robot = run(Robot, executor=executor(), world=BOX, factor=5.0)
    observer.drive(0.2)
    wait_until(lambda: robot.simulation.true_place()[0] > 0.2)
    stop(robot)
    wait_until(lambda: not observer.get_publishers_info_by_topic("/odom"), "the end of the robot")


def test_the_picture_has_all_robots(observer: Observer) -> None:
    robot = robot_in_box()
    run(Robot, world=BOX, namespace="/robot2")
    picture = robot.picture()
    assert max(picture.size) == 500
    assert "robot 0 at (0.00, 0.00) m" in picture.info["Description"]
    assert "robot 1 at" in picture.info["Description"]


# As a program


def program(*parameters: str) -> subprocess.Popen[str]:
    """`ros2 run course_robot robot`, which starts `python -m course_kit.robots.robot`."""
    words = [word for parameter in parameters for word in ("-p", parameter)]
    (executable,) = packages.executables("course_robot")
    assert executable.name == "robot"
    arguments = [str(executable), "--ros-args", *words]
    return subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def test_as_a_program(observer: Observer) -> None:
    odometry = observer.hear(Odometry, "/odom")
    robot = program("world:=maze", "seed:=3", "factor:=5")
    try:
        wait_until(lambda: odometry, "/odom of the program", 60)
    finally:
        robot.send_signal(signal.SIGINT)
        _, errors = robot.communicate(timeout=60)
    assert robot.returncode == 0
    assert "Traceback" not in errors


@pytest.mark.parametrize(
    ("parameter", "line"),
    [
        ("world:=mars", "There is no world 'mars'"),
        ("factor:=-1", "parameter factor must be simulated seconds a second"),
        ("start:=[0.0]", "parameter start must be x, y in m and a heading in rad"),
        ("enable_stamped_cmd_vel:=3", "enable_stamped_cmd_vel"),
        ("scan_noise:=x", "parameter scan_noise must be a number, 0 or more"),
    ],
)
def test_a_bad_parameter_is_one_line(parameter: str, line: str) -> None:
    robot = program(parameter)
    _, said = robot.communicate(timeout=60)
    assert robot.returncode == 1
    assert said.startswith("robot cannot start: ")
    assert line in said
    assert said.count("\n") == 1
