"""A robot seen through its topics, in whatever process it runs. Shows nothing itself."""

from __future__ import annotations

import struct
from collections import deque
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseArray, PoseStamped, PoseWithCovarianceStamped
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from course_kit.robots.navigation.messages import place_of, points_of, rays_of, stamped_pose
from course_kit.robots.navigation.places import Place, hits
from course_kit.robots.robot.picture import Cells
from course_kit.ros.subscriptions import observer_node, topics
from course_kit.ros.subscriptions.listening import close_all
from course_kit.ros.subscriptions.raw_subscriptions import Callback, RawSubscription
from course_kit.views.live.seen_robot import SeenRobot, in_numbers

PARTICLES = 500  # that are drawn, at most
TRANSFORMS = 20  # messages of one frame that are looked at, at most: a robot that hurries sends thousands a second
# What a subscription asks for at first.
PASSING: dict[str, Any] = {}
SENSED = {"reliability": ReliabilityPolicy.BEST_EFFORT}
KEPT = {"durability": DurabilityPolicy.TRANSIENT_LOCAL}


class RobotTopics:
    """The robot of one namespace, `robot`, brought up to date by take()."""

    def __init__(self, namespace: str) -> None:
        name = namespace.strip("/")
        self._prefix = f"/{name}/" if name else "/"
        self.robot = SeenRobot(name or "robot")
        self.time: float | None = None  # s, on /clock
        self.touches = ""  # what its bumper touches now
        self.refused: list[str] = []  # topics of other types than they should be
        self._came: dict[str, bytes] = {}  # the last message of each topic
        self._transforms: dict[bytes, deque[bytes]] = {}  # by the frames of the first one in a message
        self._readers: dict[str, tuple[Any, Callable[[Any], None]]] = {}
        self._subscriptions: dict[str, RawSubscription] = {}
        self.odometry, self.goals = self.absolute("odom"), self.absolute("goal_pose")
        self._node, self._executor = observer_node.node(), observer_node.executor()
        self._goals = self._node.create_publisher(PoseStamped, self.goals, 5)
        self._listen(self.odometry, Odometry, SENSED, self._on_odometry)
        self._listen(self.absolute("scan"), LaserScan, SENSED, self._on_scan)
        self._listen(self.absolute("map"), OccupancyGrid, KEPT, self._on_map)
        self._listen(self.absolute("plan"), Path, PASSING, self._on_plan)
        self._listen(self.goals, PoseStamped, PASSING, self._on_goal)
        self._listen(self.absolute("amcl_pose"), PoseWithCovarianceStamped, KEPT, self._on_estimate)
        self._listen(self.absolute("particle_cloud"), PoseArray, SENSED, self._on_particles)
        self._listen(self.absolute("bumper"), String, KEPT, self._on_bumper)
        self._listen("/clock", Clock, SENSED, self._on_clock)
        self._subscribe("/tf", TFMessage, PASSING, partial(_append, self._transforms))
        self._subscribe("/tf_static", TFMessage, KEPT, partial(_append, self._transforms))

    def absolute(self, name: str) -> str:
        """The full name of a topic of the robot."""
        return self._prefix + name

    @property
    def is_there(self) -> bool:
        """True if a node publishes its odometry."""
        return self._node.count_publishers(self.odometry) > 0

    @property
    def is_open(self) -> bool:
        """True if ROS still runs."""
        return bool(self._node.context.ok())

    def close(self) -> None:
        """End all that it has opened."""
        close_all(self._subscriptions)
        # In its node's thread: what is destroyed while that waits for it raises.
        self._executor.create_task(self._node.destroy_publisher, self._goals)

    def take(self) -> None:
        """Have the robot tell what has come since the last call."""
        for waiting in list(self._transforms.values()):
            for _ in range(len(waiting)):
                self._on_transforms(deserialize_message(waiting.popleft(), TFMessage))
        for topic in list(self._came):
            message_type, read = self._readers[topic]
            read(deserialize_message(self._came.pop(topic), message_type))

    def send_goal(self, place: Place) -> str:
        """Publish a goal, which is a place of the picture; what is to be said of it."""
        goal = self.robot.named(place)
        self._goals.publish(stamped_pose(goal, self.robot.frame, self._now()))
        told = f"Goal {in_numbers(goal)} in frame '{self.robot.frame}' on {self.goals}"
        own = self._node.get_fully_qualified_name()
        others = [one for one in topics.subscriptions(self._node, self.goals) if topics.node_name(one) != own]
        return f"{told}." if others else f"{told}: no node subscribes to that, so nothing drives there."

    def _now(self) -> Time:
        """The simulated time where there is one."""
        if self.time is None:
            return self._node.get_clock().now().to_msg()
        return Time(sec=int(self.time), nanosec=round(self.time % 1 * 1e9) % 10**9)

    # What comes: kept in the watching thread, and read in that of take().

    def _listen(self, topic: str, message_type: Any, qos: dict[str, Any], read: Callable[[Any], None]) -> None:
        self._readers[topic] = message_type, read
        self._subscribe(topic, message_type, qos, partial(_keep, self._came, topic))

    def _subscribe(self, topic: str, message_type: Any, qos: dict[str, Any], callback: Callback) -> None:
        try:
            subscription = observer_node.subscribe_exactly(topic, callback, message_type, QoSProfile(depth=10, **qos))
            self._subscriptions[topic] = subscription
        except TypeError as error:
            self.refused.append(f"{topic} is not drawn: {error}.")

    def _on_odometry(self, message: Odometry) -> None:
        header = message.header
        self.robot.drive(header.frame_id, message.child_frame_id, place_of(message.pose.pose), _seconds(header.stamp))

    def _on_scan(self, message: LaserScan) -> None:
        self.robot.scan(message.header.frame_id, _seconds(message.header.stamp), hits(*rays_of(message)))

    def _on_transforms(self, message: TFMessage) -> None:
        for one in message.transforms:
            place, time = place_of(one.transform), _seconds(one.header.stamp)
            self.robot.frames.add(one.header.frame_id, one.child_frame_id, place, time)

    def _on_bumper(self, message: String) -> None:
        self.touches = message.data

    def _on_clock(self, message: Clock) -> None:
        self.time = _seconds(message.clock)

    def _on_plan(self, message: Path) -> None:
        self.robot.lay("plan", message.header.frame_id, points_of(message))

    def _on_goal(self, message: PoseStamped) -> None:
        self.robot.lay("goal", message.header.frame_id, place_of(message.pose))

    def _on_estimate(self, message: PoseWithCovarianceStamped) -> None:
        self.robot.lay("estimate", message.header.frame_id, place_of(message.pose.pose))

    def _on_particles(self, message: PoseArray) -> None:
        places = np.array([place_of(one) for one in message.poses], np.float64).reshape(-1, 3)
        self.robot.lay("particles", message.header.frame_id, places[:: max(1, -(-len(places) // PARTICLES))])

    def _on_map(self, message: OccupancyGrid) -> None:
        info = message.info
        if len(message.data) == info.width * info.height > 0 and info.resolution > 0:
            values = np.asarray(message.data, np.int8).reshape(info.height, info.width)
            x, y, turn = place_of(info.origin)
            self.robot.lay("map", message.header.frame_id, Cells(values, float(info.resolution), (x, y), turn))


def _keep(came: dict[str, bytes], topic: str, serialised: bytes, _: dict[str, Any]) -> None:
    came[topic] = serialised


def _append(came: dict[bytes, deque[bytes]], serialised: bytes, _: dict[str, Any]) -> None:
    frames = _first_frames(serialised)
    if frames not in came:
        came[frames] = deque(maxlen=TRANSFORMS)
    came[frames].append(serialised)


def _first_frames(serialised: bytes) -> bytes:
    """The names of the frames of the first transform in a serialised TFMessage, at a tenth of the cost of all of it."""
    if len(serialised) < 24:  # there is none in it
        return b""
    length = "<I" if serialised[1] & 1 else ">I"
    (name,) = struct.unpack_from(length, serialised, 16)  # after how many there are, and the first one's stamp
    child = 20 + name + -name % 4
    (child_name,) = struct.unpack_from(length, serialised, child)
    return serialised[16 : child + 4 + child_name]


def _seconds(stamp: Time) -> float:
    return float(stamp.sec + 1e-9 * stamp.nanosec)
