"""The instruments: their node, raw subscriptions with real traffic, errors as a student sees them, a clean end."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message
from std_msgs.msg import Int32, String

from course_kit.ros.spinning import context, errors
from course_kit.ros.subscriptions import observer_node, topics
from tests.senders import Sender
from tests.waiting import interrupted_when, wait_until


@pytest.fixture
def talker() -> Iterator[Node]:
    context.start()
    node = Node("talker")
    yield node
    node.destroy_node()


def publish(publisher: Any, *texts: str) -> None:
    wait_until(lambda: publisher.get_subscription_count() > 0)
    for text in texts:
        publisher.publish(String(data=text))


class Listener:
    """Keeps the text of serialised String messages, and their infos."""

    def __init__(self) -> None:
        self.texts: list[str] = []
        self.infos: list[dict[str, Any]] = []

    def __call__(self, message: bytes, info: dict[str, Any]) -> None:
        self.texts.append(deserialize_message(message, String).data)
        self.infos.append(info)


def test_the_node_is_hidden_has_no_services_and_is_one() -> None:
    observer_node.stop()
    observer_node.appear_as("_course_kit", with_rosout=False)  # a `ros2` in this process names it otherwise
    node = observer_node.node()
    assert node.get_name() == f"_course_kit_{os.getpid()}"
    assert list(node.services) == []
    assert observer_node.node() is node


def test_timers_of_the_node_run_also_after_one_raised() -> None:
    ticks: list[int] = []

    def tick() -> None:
        ticks.append(1)
        raise RuntimeError("a broken view")

    timer = observer_node.node().create_timer(0.005, tick)
    wait_until(lambda: len(ticks) > 3)
    observer_node.executor().create_task(observer_node.node().destroy_timer, timer)
    assert any("a broken view" in e.title for e in errors.errors())


def test_what_ends_with_the_node_is_called_when_nothing_spins_it_any_more() -> None:
    name, ended = observer_node.node().get_name(), []

    def note(node: Node) -> None:
        ended.append((node.get_name(), [t.name for t in threading.enumerate() if t.name == "course_kit instruments"]))

    observer_node.before_end(note)
    observer_node.stop()
    observer_node.stop()
    assert ended == [(name, [])]


def test_serialised_messages_and_when_they_arrived_are_delivered_in_order(talker: Node) -> None:
    listener = Listener()
    publisher = talker.create_publisher(String, "chatter", 100)
    before = time.time_ns()
    subscription = observer_node.subscribe("chatter", listener)  # neither type nor leading slash
    publish(publisher, *map(str, range(50)))
    wait_until(lambda: len(listener.texts) == 50)
    assert listener.texts == list(map(str, range(50)))
    received = [info["received_timestamp"] for info in listener.infos]
    assert received == sorted(received) and before < received[0] <= received[-1] < time.time_ns()
    assert (subscription.topic, subscription.type) == ("/chatter", "std_msgs/msg/String")
    subscription.close()


def test_close_delivers_what_has_arrived_and_then_nothing(talker: Node) -> None:
    listener = Listener()
    publisher = talker.create_publisher(String, "/chatter", 2000)
    subscription = observer_node.subscribe("/chatter", listener)
    other = observer_node.subscribe("/chatter", Listener())
    wait_until(lambda: publisher.get_subscription_count() == 2)
    publish(publisher, *["x"] * 1000)
    subscription.close()
    subscription.close()
    assert len(listener.texts) == 1000 and not subscription.is_open and other.is_open
    publisher.publish(String(data="later"))
    wait_until(lambda: len(other.callback.texts) == 1001)  # type: ignore[attr-defined]
    assert len(listener.texts) == 1000
    other.close()


def test_a_callback_may_close_its_own_subscription(talker: Node) -> None:
    publisher = talker.create_publisher(String, "/chatter", 10)
    subscription = observer_node.subscribe("/chatter", lambda *_: subscription.close())
    publish(publisher, "x")
    assert subscription.closed.wait(10)


def test_an_exception_in_a_callback_is_reported_and_stops_nobody(talker: Node) -> None:
    publisher = talker.create_publisher(String, "/chatter", 10)
    listener = Listener()
    wrong: dict[str, str] = {}
    faulty = observer_node.subscribe("/chatter", lambda *_: print(wrong["no such key"]))
    sound = observer_node.subscribe("/chatter", listener)
    publish(publisher, "a", "b", "c")
    wait_until(lambda: len(listener.texts) == 3)
    wait_until(lambda: any("no such key" in e.title and e.count == 3 for e in errors.errors()))
    faulty.close()
    sound.close()


@pytest.mark.parametrize("reliability", list(ReliabilityPolicy)[1:3])
def test_a_publisher_that_comes_later_is_heard_whatever_its_reliability(
    talker: Node, reliability: ReliabilityPolicy
) -> None:
    listener = Listener()
    subscription = observer_node.subscribe("/chatter", listener, String)
    publisher = talker.create_publisher(String, "/chatter", QoSProfile(depth=10, reliability=reliability))
    publish(publisher, "hello")
    wait_until(lambda: listener.texts == ["hello"])
    subscription.close()


def test_reliable_and_best_effort_publishers_of_one_topic_are_both_heard(talker: Node) -> None:
    listener = Listener()
    reliable = talker.create_publisher(String, "/chatter", 10)
    with Sender("/chatter", "string", count=5, qos="best_effort") as sender:
        wait_until(lambda: talker.count_publishers("/chatter") == 2)
        subscription = observer_node.subscribe("/chatter", listener)
        sender.go()
        publish(reliable, "here")
        wait_until(lambda: "here" in listener.texts and "000000000004" in listener.texts)
    subscription.close()


def test_a_subscription_that_cannot_ask_for_less_ends_no_other_one(talker: Node) -> None:
    stuck, sound = Listener(), Listener()
    reliable = talker.create_publisher(String, "/stuck", 10)
    steady = talker.create_publisher(String, "/steady", 10)
    subscriptions = [observer_node.subscribe("/stuck", stuck), observer_node.subscribe("/steady", sound)]
    subscriptions[0].topic = "no name of a topic"  # so that it cannot be opened again
    best_effort = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
    refused = talker.create_publisher(String, "/stuck", best_effort)
    wait_until(lambda: any("no name of a topic" in str(e) for e in errors.errors()))
    publish(steady, "goes on")
    wait_until(lambda: sound.texts == ["goes on"])
    publish(reliable, "goes on too")
    wait_until(lambda: stuck.texts == ["goes on too"])
    assert refused.get_subscription_count() == 0
    for subscription in subscriptions:
        subscription.close()


def test_a_latched_message_from_before_is_received() -> None:
    listener = Listener()
    with Sender("/latched", "string", count=1, qos="latched") as sender:
        sender.go()
        sender.result()
        subscription = observer_node.subscribe("/latched", listener)
        wait_until(lambda: listener.texts == ["000000000000"])
        subscription.close()


def test_a_student_callback_that_blocks_does_not_stall_the_instruments(talker: Node) -> None:
    from course_kit.lab.background import running

    release = threading.Event()

    class Blocking(Node):
        def __init__(self) -> None:
            super().__init__("blocking")
            self.busy = False
            self.create_subscription(String, "/chatter", self.block, 10)

        def block(self, _: String) -> None:
            self.busy = True
            release.wait(20)

    student = running.run(Blocking)
    listener = Listener()
    publisher = talker.create_publisher(String, "/chatter", 100)
    subscription = observer_node.subscribe("/chatter", listener)
    wait_until(lambda: publisher.get_subscription_count() == 2)
    publish(publisher, *["x"] * 100)
    wait_until(lambda: student.busy and len(listener.texts) == 100)
    release.set()
    running.stop(student)
    subscription.close()


def test_a_misspelt_topic_is_answered_with_the_near_one(talker: Node) -> None:
    talker.create_publisher(String, "/turtle1/pose", 10)
    with pytest.raises(TimeoutError, match=r"no node publishes /turtle1/pos \(.*\). Did you mean /turtle1/pose\?"):
        observer_node.subscribe("turtle1/pos", print, timeout=0.2)
    with pytest.raises(TimeoutError, match=r"no node publishes /pose .*Did you mean /turtle1/pose\?"):
        observer_node.subscribe("/pose", print, timeout=0.2)


def test_the_topic_is_waited_for() -> None:
    with Sender("/soon", "string") as sender:
        subscription = observer_node.subscribe("/soon", listener := Listener())
        sender.go()
        wait_until(lambda: len(listener.texts) > 10)
        subscription.close()


def test_two_types_on_one_topic_are_named_with_their_nodes(talker: Node) -> None:
    talker.create_publisher(String, "/mixed", 10)
    with Sender("/mixed", "int"):
        wait_until(lambda: talker.count_publishers("/mixed") == 2)
        with pytest.raises(TypeError) as error:
            observer_node.subscribe("/mixed", print)
    assert "std_msgs/msg/Int32 from /sender_of_int" in str(error.value)
    assert "std_msgs/msg/String from /talker" in str(error.value)


def test_a_subscription_that_is_interrupted_before_it_has_all_publishers_ends(talker: Node) -> None:
    publisher = talker.create_publisher(String, "/mixed", 10)
    with Sender("/mixed", "int"):  # with whom a subscription to strings never matches
        wait_until(lambda: talker.count_publishers("/mixed") == 2)
        with interrupted_when(lambda: publisher.get_subscription_count() == 1):
            observer_node.subscribe("/mixed", print, String)
    wait_until(lambda: publisher.get_subscription_count() == 0)


@pytest.mark.parametrize(
    ("topic", "wanted", "raised", "says"),
    [
        ("/chatter", Int32, TypeError, "does not carry std_msgs/msg/Int32 but std_msgs/msg/String from /talker"),
        ("/chatter", "no_msgs/msg/Nothing", ModuleNotFoundError, "does not know the package no_msgs"),
        ("/chatter", "std_msgs/msg/Strin", ValueError, "Did you mean std_msgs/msg/String?"),
        ("/chatter", "String", ValueError, "is not a message type. Write it like 'std_msgs/msg/String'"),
        ("/chatter", 3, TypeError, "is not a message type"),
        ("/two words", String, ValueError, "cannot be the name of a topic"),
    ],
)
def test_bad_input_is_answered_in_one_line(
    talker: Node, topic: str, wanted: Any, raised: type[Exception], says: str
) -> None:
    talker.create_publisher(String, "/chatter", 10)
    with pytest.raises(raised) as error:
        observer_node.subscribe(topic, print, wanted)
    assert says in str(error.value) and "\n" not in str(error.value)


def test_a_type_that_clashes_with_a_subscription_of_this_process_is_refused(talker: Node) -> None:
    talker.create_subscription(String, "/heard", print, 10)
    with pytest.raises(TypeError, match=r"/heard is used in this process with another type than std_msgs/msg/Int32"):
        observer_node.subscribe("/heard", print, Int32)


@pytest.mark.parametrize(
    "name", ["std_msgs/msg/String", "turtlesim/msg/Pose", "example_interfaces/action/Fibonacci_FeedbackMessage"]
)
def test_a_type_name_gives_its_class_and_back(name: str) -> None:
    assert topics.type_name(topics.message_class(name)) == name


AGAIN = "subscription = observer_node.subscribe('/program', print, String)"
ENDINGS = {
    "with everything running": "",
    "after rclpy.shutdown()": "rclpy.shutdown()",
    "after shutdown and a new start": f"rclpy.shutdown(); {AGAIN}",
    "with an exception": "import atexit; atexit.register(lambda: None); raise SystemExit(0)",
}
PROGRAM = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import String
from course_kit.ros.spinning import context
from course_kit.base.polling import wait_until
from course_kit.ros.subscriptions import observer_node, topics
got = []
subscription = observer_node.subscribe('/program', lambda message, info: got.append(message), String)
talker = Node('talker')
publisher = talker.create_publisher(String, '/program', 10)
observer_node.node().create_timer(0.001, lambda: rclpy.ok() and publisher.publish(String(data='x')))
assert wait_until(lambda: len(got) > 20, 20)
"""


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_process_ends_cleanly(ending: str) -> None:
    done = subprocess.run([sys.executable, "-c", PROGRAM + ENDINGS[ending]], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")


def test_the_instruments_start_again_after_rclpy_shutdown() -> None:
    program = """
first, old = observer_node.node(), subscription
rclpy.shutdown()
assert wait_until(lambda: not old.is_open, 10)
again = []
subscription = observer_node.subscribe('/program', lambda message, info: again.append(message), String)
assert observer_node.node() is not first and subscription.is_open
publisher = Node('talker').create_publisher(String, '/program', 10)
publisher.publish(String(data='x'))
assert wait_until(lambda: again, 10)
old.close()
"""
    done = subprocess.run([sys.executable, "-c", PROGRAM + program], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")
