"""A turtle simulator seen through its topics and services, in whatever process it runs. Shows nothing itself."""

from __future__ import annotations

import struct
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable
from typing import Any

from example_interfaces.srv import Trigger
from rcl_interfaces.msg import ParameterEvent, ParameterType
from rcl_interfaces.srv import GetParameters
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message
from rclpy.topic_endpoint_info import TopicEndpointInfo
from std_msgs.msg import String
from turtlesim.msg import Color, Pose

from course_kit.robots.turtlesim import drawing_report
from course_kit.robots.turtlesim.field import MIDDLE
from course_kit.robots.turtlesim.seen_field import SeenField
from course_kit.ros.subscriptions import clients, observer_node, topics
from course_kit.ros.subscriptions.listening import close_all
from course_kit.ros.subscriptions.raw_subscriptions import Callback, RawSubscription

POSE = "turtlesim/msg/Pose"
BACKGROUND = ("background_r", "background_g", "background_b")
FOUND, ANSWERED = 1.0, 3.0  # seconds that a service may take to be found, and to answer
START = (MIDDLE, MIDDLE, 0.0)
Info = dict[str, Any]  # of a message
# x, y and theta of a serialised pose, by its byte order: a tenth of what rclpy takes for the whole message.
PLACES = {0: struct.Struct(">3f"), 1: struct.Struct("<3f")}


class TurtleTopics:
    """The turtles of one namespace on a `field`, brought up to date by take().

    The course's simulator tells what it draws (drawing_report.py). Of another one, such as the original, the colour
    under a turtle that has come to rest tells its pen's; what it does not tell is a pen's width, a pen that was changed
    twice on the way, trails from before somebody looked, and clear while no turtle rests on a trail.
    """

    def __init__(self, turtle: str, namespace: str) -> None:
        """Raises TypeError if the turtle's pose carries another type than turtlesim's."""
        self.field = SeenField()
        self.on_silence: Callable[[str], None] = lambda _: None
        self._prefix = f"/{namespace.strip('/')}/" if namespace.strip("/") else "/"
        self._drawing = self._prefix + drawing_report.TOPIC
        self._came: deque[tuple[int, Callable[..., None], tuple[Any, ...]]] = deque()
        self._simulators: set[str] = set()  # their nodes
        self._published_once: set[str] = set()  # turtles whose poses one simulator alone publishes
        self._counts: dict[str, int] = {}  # of their last poses, as their publishers count
        self._poses: dict[str, RawSubscription] = {}
        self._others: dict[str, RawSubscription] = {}
        topic = self.pose_topic(turtle)
        self._poses[turtle] = observer_node.subscribe(topic, self._receiver(self._on_pose, turtle), POSE)
        self._listen("/parameter_events", ParameterEvent, self._receiver(self._on_parameters), QoSProfile(depth=100))
        self._listen(self._drawing, String, self._receiver(self._on_drawing), drawing_report.LATCHED)
        self.look()

    def pose_topic(self, turtle: str) -> str:
        """The topic of a turtle's poses."""
        return self.absolute(f"{turtle}/pose")

    def absolute(self, name: str) -> str:
        """The full name of a topic or service of the simulator."""
        return self._prefix + name

    @property
    def misses_poses(self) -> bool:
        """True if the simulator has told of turtles whose poses do not come yet: it is time to look()."""
        return bool(self.field.turtles.keys() - self._poses.keys())

    def ask(self, service_type: Any, name: str, then: Callable[[Any], None], /, **request: Any) -> None:
        """Call a service from a thread of its own; `then(answer)` happens at a take(), or `on_silence(why)` does."""

        def call() -> None:
            try:
                answer = clients.call(service_type, name, service_type.Request(**request), FOUND, ANSWERED)
            except Exception as error:  # it is not there, gives no answer, or ROS has ended
                self._came.append((time.time_ns(), self.on_silence, (str(error),)))
            else:
                self._came.append((time.time_ns(), then, (answer,)))

        threading.Thread(target=call, name=f"call of {name}", daemon=True).start()

    def close(self) -> None:
        """End all subscriptions."""
        close_all(self._others)
        close_all(self._poses)

    def take(self) -> None:
        """Have what has come since the last call happen on the field, in the order in which it was sent."""
        came = sorted((self._came.popleft() for _ in range(len(self._came))), key=lambda one: one[0])
        for _, act, arguments in came:
            act(*arguments)

    def look(self) -> None:
        """Look in the graph for turtles that came or went; a few times a second suffices."""
        there = self._published()
        known = there.keys() & self.field.turtles.keys()
        for name in there.keys() - self._poses.keys():
            qos = topics.qos_for(self.pose_topic(name), there[name])
            receiver = self._receiver(self._on_pose, name)
            self._poses[name] = observer_node.subscribe_exactly(
                self.pose_topic(name), receiver, Pose, qos, lambda _: None
            )
        self._published_once = {name for name, publishers in there.items() if len(publishers) == 1}
        tells = bool(observer_node.node().count_publishers(self._drawing))
        self.field.is_told = self.field.is_told and tells
        if not self.field.is_told:
            for name in there.keys() - self.field.turtles.keys():
                self.field.add(name)
            for name in self.field.turtles.keys() - there.keys():
                self.field.remove(name)
        if not tells:
            self._feel(known)  # not the new ones: of a new simulator nobody knows yet what it tells
        simulators = {topics.node_name(one) for publishers in there.values() for one in publishers}
        for simulator in simulators - self._simulators:
            self.ask(GetParameters, f"{simulator}/get_parameters", self._on_background, names=BACKGROUND)
        self._simulators = simulators

    def _feel(self, turtles: Iterable[str]) -> None:
        """Have the colours under turtles come in: with a simulator of another make they tell of the pens."""
        for name in turtles:
            topic = self.absolute(f"{name}/color_sensor")
            if topic not in self._others:
                qos = topics.qos_for(topic, topics.publishers(observer_node.node(), topic))
                self._listen(topic, Color, self._receiver(self._on_color, name), qos)

    def _published(self) -> dict[str, list[TopicEndpointInfo]]:
        """The turtles whose poses somebody publishes, with the publishers."""
        node, found = observer_node.node(), {}
        for topic, types in node.get_topic_names_and_types():
            if POSE in types and topic.startswith(self._prefix) and topic.endswith("/pose"):
                name = topic[len(self._prefix) : -len("/pose")]
                publishers = topics.publishers(node, topic)
                # a/b is a turtle of this name, or the turtle b of a simulator in the namespace a.
                ours = any(f"{one.node_namespace.rstrip('/')}/" == self._prefix for one in publishers)
                if publishers and ("/" not in name or ours):
                    found[name] = publishers
        return found

    # What comes: noted in the watching thread, and happens in that of take().

    def _listen(self, topic: str, message_type: Any, callback: Callback, qos: QoSProfile) -> None:
        self._others[topic] = observer_node.subscribe_exactly(topic, callback, message_type, qos, lambda _: None)

    def _receiver(self, act: Callable[..., None], *arguments: Any) -> Callback:
        came = self._came

        def note(serialised: bytes, info: Info) -> None:
            came.append((info["source_timestamp"], act, (*arguments, serialised, info)))

        return note

    def _on_pose(self, name: str, serialised: bytes, info: Info) -> None:
        place = PLACES[serialised[1] & 1].unpack_from(serialised, 4)
        before, self._counts[name] = self._counts.get(name, 0), info["publication_sequence_number"]
        if not self.field.is_told and self._counts[name] < before and name in self._published_once:
            self.field.add(name)  # another publisher counts: that turtle was killed, this one spawned
            if name == "turtle1" and place == START:
                self.field.wipe()  # by a reset
        self.field.move(name, *place)

    def _on_color(self, name: str, serialised: bytes, _: Info) -> None:
        red, green, blue = serialised[4:7]
        self.field.feel(name, (red, green, blue))

    def _on_drawing(self, serialised: bytes, _: Info) -> None:
        if not self.field.is_told:
            self.ask(Trigger, self._prefix + drawing_report.SERVICE, self._on_trails)
        self.field.tell(drawing_report.drawing_of(deserialize_message(serialised, String).data))

    def _on_trails(self, answer: Trigger.Response) -> None:
        self.field.take_over(drawing_report.trails_of(answer.message))

    def _on_parameters(self, serialised: bytes, _: Info) -> None:
        event = deserialize_message(serialised, ParameterEvent)
        if event.node in self._simulators:
            changed = {one.name: one.value.integer_value for one in event.changed_parameters if one.name in BACKGROUND}
            self._paint(changed)

    def _on_background(self, answer: GetParameters.Response) -> None:
        if all(value.type == ParameterType.PARAMETER_INTEGER for value in answer.values):
            self._paint(dict(zip(BACKGROUND, (value.integer_value for value in answer.values), strict=False)))

    def _paint(self, changed: dict[str, int]) -> None:
        if changed:
            red, green, blue = (
                changed.get(n, before) for n, before in zip(BACKGROUND, self.field.background, strict=True)
            )
            self.field.paint((red, green, blue))
