"""What a form sends with real nodes: topics, services, actions, the same by `ros2` and by the program that it shows."""

from __future__ import annotations

import shlex
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import closing
from typing import Any

import pytest
from example_interfaces.action import Fibonacci
from geometry_msgs.msg import Twist
from nav_msgs.msg import Path
from nav_msgs.srv import GetPlan
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String
from std_srvs.srv import Trigger

from course_kit.cli.ros2.messages.yaml_text import to_dict
from course_kit.ros.spinning import context
from course_kit.ros.spinning.executors import SpinThread
from course_kit.ros.subscriptions import observer_node
from course_kit.views.forms import calling
from course_kit.views.forms.calling import GoalSender
from course_kit.views.forms.command_line import command_line
from course_kit.views.forms.fields import read
from course_kit.views.forms.interface import ACTION, SERVICE, TOPIC, Interface
from course_kit.views.forms.lookup import find
from course_kit.views.forms.program import program
from course_kit.views.forms.sender import Sender
from course_kit.views.forms.sending import Publishing, sender
from tests import ros2_command
from tests.test_forms import filled
from tests.waiting import wait_until

POSE = {
    "header": {"stamp": "12.5", "frame_id": 'it\'s "here"'},
    "pose": {
        "position": {"x": "1.5", "y": "-2", "z": "1e-300"},
        "orientation": {"x": "0", "y": "0", "z": "nan", "w": "1"},
    },
}


class Other(Node):
    """Who gets what forms send: it keeps all of it, plans a path, and counts until it is told to cancel."""

    def __init__(self) -> None:
        super().__init__("other")
        self.got: list[Any] = []
        self.may_end = threading.Event()
        group = ReentrantCallbackGroup()
        self.create_subscription(Path, "path", self.got.append, 10)
        self.create_subscription(Twist, "both", self.got.append, 10)
        self.create_service(Trigger, "both", lambda _, response: response)
        self.create_service(GetPlan, "plan", self.plan, callback_group=group)
        self.actions = ActionServer(
            self,
            Fibonacci,
            "count",
            self.count,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
            callback_group=group,
        )

    def plan(self, request: Any, response: Any) -> Any:
        self.got.append(request)
        response.plan.poses = [request.start, request.goal]
        return response

    def count(self, goal: Any) -> Any:
        self.got.append(goal.request)
        goal.publish_feedback(Fibonacci.Feedback(sequence=[0, 1]))
        while not goal.is_cancel_requested and not self.may_end.wait(0.01):
            pass
        if goal.is_cancel_requested:
            goal.canceled()
        else:
            goal.succeed()
        return Fibonacci.Result(sequence=[0, 1, 1])


@pytest.fixture(scope="module")
def other() -> Iterator[Other]:
    context.start()
    node = Other()
    failed: list[Exception] = []
    with closing(SpinThread(node, failed.append, MultiThreadedExecutor(4)).start()):
        yield node
    assert not failed


@pytest.fixture
def open_senders() -> Iterator[Callable[[Interface], Any]]:
    made: list[Sender] = []

    def open_one(interface: Interface) -> Sender:
        made.append(sender(interface))
        return made[-1]

    yield open_one
    for one in made:
        one.close()


def value_of(interface: Interface, entries: dict[str, Any]) -> Any:
    value, problems = read(interface.root, filled(interface.message_type, entries))
    assert problems == {}
    return value


def line(one: Sender, begins: str) -> str:
    """What a sender says, once it begins so and is over."""
    wait_until(lambda: one.state.line.startswith(begins) and not one.state.is_busy, f"{begins!r}")
    return one.state.line


SENT = [
    (Interface(TOPIC, "/path", Path), {"header.frame_id": "map", "poses": [POSE, POSE]}),
    (Interface(SERVICE, "/plan", GetPlan), {"start": POSE, "tolerance": "0.5"}),
    (Interface(ACTION, "/count", Fibonacci), {"order": "3"}),
]


@pytest.mark.parametrize(("interface", "entries"), SENT, ids=[TOPIC, SERVICE, ACTION])
def test_form_command_and_program_send_the_same(interface, entries, other, open_senders):
    other.got.clear()
    other.may_end.set()
    value = value_of(interface, entries)
    by_form = open_senders(interface)
    if interface.noun == TOPIC:
        wait_until(lambda: by_form._publisher.get_subscription_count())
    by_form.send(value)
    wait_until(lambda: other.got and not by_form.state.is_busy)
    outcome = ros2_command.ros2(*shlex.split(command_line(interface, value))[1:])
    assert (outcome.err, outcome.status) == ("", 0)
    words = [sys.executable, "-c", program(interface, value)]
    done = subprocess.run(words, capture_output=True, text=True, timeout=60)
    assert (done.stderr, done.returncode) == ("", 0)
    wait_until(lambda: len(other.got) == 3)
    wanted, *others = [repr(to_dict(message)) for message in other.got]
    assert others == [wanted] * 2
    if interface.noun == SERVICE:
        assert by_form.state.answer.startswith("plan:\n") and 'it\'s "here"' in by_form.state.answer
    if interface.noun == ACTION:
        assert by_form.state.answer == "result:\n  sequence:\n  - 0\n  - 1\n  - 1"
        assert by_form.state.line.startswith("SUCCEEDED after ")


def test_a_time_now_is_the_time_of_each_sending(other, open_senders):
    other.got.clear()
    interface = Interface(TOPIC, "/path", Path)
    publishing: Publishing = open_senders(interface)
    wait_until(lambda: publishing._publisher.get_subscription_count())
    publishing.start(value_of(interface, {"header.stamp": "now"}), 50.0)
    wait_until(lambda: len(other.got) >= 3)
    assert publishing.state.line.startswith("publishing at 50 Hz, ") and publishing.state.is_busy
    publishing.update(value_of(interface, {"header.stamp": "now", "header.frame_id": "newer"}))
    wait_until(lambda: other.got[-1].header.frame_id == "newer")
    publishing.stop()
    stamps = [(one.header.stamp.sec, one.header.stamp.nanosec) for one in other.got]
    assert stamps == sorted(set(stamps))
    now, _ = other.get_clock().now().seconds_nanoseconds()
    assert 0 <= now - stamps[0][0] < 60
    count = publishing._sent
    assert publishing.state.line == f"{count:,} sent, to 1 subscription" and not publishing.state.is_busy


def test_a_form_says_that_nobody_gets_what_it_publishes(other, open_senders):
    publishing = open_senders(Interface(TOPIC, "/nobody", String))
    publishing.send({"data": "x"})
    assert publishing.state.line == "1 sent, to nobody: no node subscribes to /nobody"


def test_a_subscription_that_asks_for_another_qos_is_named(other, open_senders):
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    other.create_subscription(String, "latched", lambda _: None, latched)
    publishing = open_senders(Interface(TOPIC, "/latched", String))
    publishing.send({"data": "x"})
    wait_until(lambda: "gets nothing, for it asks for another durability" in publishing.state.line)


def test_a_goal_is_followed_and_cancelled(other, open_senders):
    other.may_end.clear()
    goal: GoalSender = open_senders(Interface(ACTION, "/count", Fibonacci))
    goal.send({"order": 3})
    wait_until(lambda: goal.state.answer == "feedback:\n  sequence:\n  - 0\n  - 1")
    assert goal.state.line.startswith("EXECUTING for ") and goal.state.is_busy
    goal.cancel()
    assert line(goal, "CANCELED after ")
    assert goal.state.answer == "result:\n  sequence:\n  - 0\n  - 1\n  - 1"


def test_a_form_that_ends_cancels_its_goal(other, open_senders):
    other.may_end.clear()
    other.got.clear()
    goal = open_senders(Interface(ACTION, "/count", Fibonacci))
    goal.send({"order": 3})
    wait_until(lambda: other.got)
    goal.close()
    assert not any(thread.name.startswith("form of") for thread in threading.enumerate())
    names = [name for name, _ in other.get_node_names_and_namespaces()]
    assert not any("_goal_" in name for name in names)


def test_a_server_that_is_not_there_refuses_is_silent_or_dies_is_told(open_senders, monkeypatch):
    monkeypatch.setattr(calling, "FOUND", 0.3)
    nobody = open_senders(Interface(SERVICE, "/nobody", Trigger))
    nobody.send({})
    assert line(nobody, "nobody") == "nobody offers /nobody (waited 0.3 s)"
    assert nobody.state.is_problem
    monkeypatch.setattr(calling, "FOUND", 20.0)
    with ros2_command.program("tests.ros2_servers", "/bad"):
        refusing = open_senders(Interface(ACTION, "/bad/refusing", Fibonacci))
        refusing.send({})
        assert line(refusing, "/bad") == "/bad/refusing has rejected the goal"
        stubborn = open_senders(Interface(ACTION, "/bad/stubborn", Fibonacci))
        stubborn.send({})
        wait_until(lambda: stubborn.state.line.startswith("ACCEPTED"))
        stubborn.cancel()
        wait_until(lambda: stubborn.state.line == "the server does not cancel this goal: it goes on")
        assert stubborn.state.is_busy
        monkeypatch.setattr(calling, "ANSWER", 0.5)
        silent = open_senders(Interface(SERVICE, "/bad/silent", Trigger))
        silent.send({})
        assert line(silent, "/bad/silent gave no answer within 0.5 s")
        monkeypatch.setattr(calling, "ANSWER", 20.0)
        mortal = open_senders(Interface(ACTION, "/bad/mortal_action", Fibonacci))
        mortal.send({})
        assert line(mortal, "the server of /bad/mortal_action ended")


def test_a_name_is_looked_up(other):
    found = find("plan", None, 10.0)
    assert (found.noun, found.name, found.type) == (SERVICE, "/plan", GetPlan)
    assert find("/count", None, 10.0).noun == ACTION
    assert find("/path", None, 10.0).type is Path
    with pytest.raises(ValueError, match="/both is a topic with geometry_msgs/msg/Twist and service with std_srvs"):
        wait_until(lambda: find("/both", None, 10.0) is None)  # one of the two may be known earlier
    assert find("/both", Trigger, 0.0).noun == SERVICE
    assert find("/both", "geometry_msgs/msg/Twist", 0.0).noun == TOPIC
    with pytest.raises(ValueError, match="the topic /path has the type nav_msgs/msg/Path, so what is sent as std_msgs"):
        find("/path", String, 0.0)
    with pytest.raises(LookupError, match=r"no node has a topic, service or action /pathh .* Did you mean /path\?"):
        find("/pathh", None, 0.1)
    assert find("/new", "std_msgs/msg/String", 0.0).noun == TOPIC


def test_opened_and_closed_200_times_nothing_is_left(other):
    def left() -> tuple[int, int, int]:
        node = observer_node.node()
        # The other node's executor makes its threads when it needs them.
        threads = [one for one in threading.enumerate() if not one.name.startswith("ThreadPoolExecutor")]
        return len(list(node.publishers)), len(list(node.timers)), len(threads)

    before = left()
    for _ in range(200):
        publishing = Publishing(Interface(TOPIC, "/path", Path))
        publishing.start({}, 100.0)
        publishing.close()
    # Fewer, where a thread of an earlier test has ended meanwhile.
    wait_until(lambda: all(now <= then for now, then in zip(left(), before, strict=True)))
