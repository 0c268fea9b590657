"""Only what was examined counts, in whatever legal style a student has written it."""

from __future__ import annotations

import contextlib
import os
import threading
import time
from collections.abc import Iterator
from itertools import pairwise

import pytest
import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import SetBool

from course_kit.exercises.checker.assertions import expect
from course_kit.exercises.checker.examination import Ended, Examination
from course_kit.exercises.checker.service_assertions import expect_service
from course_kit.exercises.checker.topic_assertions import expect_topic, listen, publish_steadily, publisher
from course_kit.exercises.in_notebook.answer_host import AnswerHost, close, obey
from course_kit.ros.spinning import context as ros_context
from course_kit.ros.spinning.executors import SpinThread
from tests.waiting import wait_until

KEEPER = "_keeper"


class Empty(Node):
    def __init__(self) -> None:
        super().__init__("talker")


class Talker(Node):
    def __init__(self) -> None:
        super().__init__("talker")
        self.words = self.create_publisher(String, "words", 10)
        self.create_timer(0.05, lambda: self.words.publish(String(data="mine")))


class PlainInit(Node):
    def __init__(self) -> None:
        Node.__init__(self, "talker")
        self.words = self.create_publisher(String, "words", 10)
        self.create_timer(0.05, lambda: self.words.publish(String(data="mine")))


class Named:
    def __init__(self, *args: object, **kwargs: object) -> None:
        super().__init__("talker", *args, **kwargs)  # type: ignore[call-arg]
        self.words = self.create_publisher(String, "words", 10)  # type: ignore[attr-defined]
        self.create_timer(0.05, self.tick)  # type: ignore[attr-defined]

    def tick(self) -> None:
        self.words.publish(String(data="mine"))


class Mixed(Named, Node):
    pass


class Managed(LifecycleNode):
    def __init__(self) -> None:
        super().__init__("talker")
        self.words = self.create_publisher(String, "words", 10)
        self.create_timer(0.05, lambda: self.words.publish(String(data="mine")))


class WithAHelper(Node):
    """What speaks is a second node, spun by an executor and a thread of the class's own."""

    def __init__(self) -> None:
        super().__init__("talker")
        self.beside = Node("beside")
        self.words = self.beside.create_publisher(String, "words", 10)
        self.beside.create_timer(0.05, lambda: self.words.publish(String(data="mine")))
        self.own_executor = SingleThreadedExecutor()
        self.own_executor.add_node(self.beside)
        self.thread = threading.Thread(target=self.own_executor.spin, daemon=True)
        self.thread.start()

    def destroy_node(self) -> None:
        self.own_executor.shutdown(1.0)
        self.thread.join(1.0)
        super().destroy_node()


class FromAThread(Node):
    def __init__(self) -> None:
        super().__init__("talker")
        self.words = self.create_publisher(String, "words", 10)
        self.done = threading.Event()
        threading.Thread(target=self.speak, daemon=True).start()

    def speak(self) -> None:
        while rclpy.ok() and not self.done.wait(0.05):
            self.words.publish(String(data="mine"))

    def destroy_node(self) -> None:
        self.done.set()
        super().destroy_node()


class Serves(Node):
    def __init__(self) -> None:
        super().__init__("lamp")
        self.create_service(SetBool, "lamp", lambda _, response: response)


@pytest.fixture
def host(examination: Examination) -> Iterator[AnswerHost]:
    with contextlib.closing(AnswerHost(examination.test_domain.domain)) as host:
        yield host


@pytest.fixture
def stranger(examination: Examination) -> Iterator[Node]:
    """A node of another context in the test domain, that says what the answer should say."""
    context = ros_context.separate(examination.test_domain.domain, "LOCALHOST")
    node = Node("talker", context=context, enable_rosout=False)
    words = node.create_publisher(String, "words", 10)
    node.create_timer(0.02, lambda: words.publish(String(data="a stranger's")))
    spinning = SpinThread(node, print, SingleThreadedExecutor(context=context)).start()
    yield node
    spinning.close()
    context.try_shutdown()


def examine(host: AnswerHost, examination: Examination, node_class: type[Node]) -> None:
    host.start(node_class, KEEPER)
    assert examination.test_domain.examine(KEEPER, 5.0, os.getpid())


def test_a_second_answer_is_not_the_first(host: AnswerHost, examination: Examination) -> None:
    for number, node_class in enumerate((Talker, Serves, Talker, Serves)):
        host.start(node_class, f"_keeper_{number}")
        assert examination.test_domain.examine(f"_keeper_{number}", 5.0, os.getpid())
        name = "/lamp" if node_class is Serves else "/talker"
        wait_until(lambda: examination.test_domain.their_nodes())
        assert examination.test_domain.their_nodes() == [name]


@pytest.mark.parametrize("node_class", [Talker, PlainInit, Mixed, Managed, WithAHelper, FromAThread])
def test_every_legal_style_is_examined(
    host: AnswerHost, examination: Examination, stranger: Node, node_class: type[Node]
) -> None:
    examine(host, examination, node_class)
    wait_until(lambda: "/talker" in examination.test_domain.their_nodes())
    expect_topic("/words", String)
    heard = listen("/words", String)
    wait_until(lambda: len(heard) > 5)
    assert {message.data for message in heard.messages} == {"mine"}
    assert heard.received > len(heard)


def test_what_another_context_says_does_not_count(host: AnswerHost, examination: Examination, stranger: Node) -> None:
    examine(host, examination, Empty)
    wait_until(lambda: examination.test_domain.their_nodes() == ["/talker"])
    heard = listen("/words", String)
    wait_until(lambda: heard.received > 20)
    assert len(heard) == 0
    with pytest.raises(Ended):
        expect_topic("/words", String)


def test_a_service_that_a_stranger_offers_too_is_no_answer(
    host: AnswerHost, examination: Examination, stranger: Node
) -> None:
    examine(host, examination, Serves)
    wait_until(lambda: examination.test_domain.their_nodes() == ["/lamp"])
    client = expect_service("/lamp", SetBool)
    assert client.ask(data=True).response is not None
    assert expect("alone", True, "")
    stranger.create_service(SetBool, "/lamp", lambda _, response: response)
    wait_until(lambda: examination.test_domain.strangers("rq/lampRequest"))
    with pytest.raises(Ended):
        expect("no longer", True, "")
    assert "/talker of another process or context" in examination.findings[-1].hint


def test_the_stage_looks_like_the_domain_of_the_notebook(host: AnswerHost) -> None:
    seen: list[int] = []

    class Looks(Node):
        def __init__(self) -> None:
            super().__init__("looks")
            seen.append(self.context.get_domain_id())
            seen.append(rclpy.get_default_context().get_domain_id())

    host.start(Looks, KEEPER)
    assert seen == [rclpy.get_default_context().get_domain_id()] * 2
    assert host.domain not in seen


@pytest.mark.parametrize(
    ("blocks", "threads", "wanted"),
    [(False, None, False), (True, None, True), (True, False, False), (False, True, True)],
)
def test_the_executor_is_the_one_that_the_node_needs(
    host: AnswerHost, blocks: bool, threads: bool | None, wanted: bool
) -> None:
    class Counts(Node):
        def __init__(self) -> None:
            super().__init__("counts")
            execute = self.execute if blocks else self.execute_async
            self.server = ActionServer(self, Fibonacci, "count", execute, callback_group=ReentrantCallbackGroup())

        def execute(self, goal: object) -> Fibonacci.Result:
            return Fibonacci.Result()

        async def execute_async(self, goal: object) -> Fibonacci.Result:
            return Fibonacci.Result()

    host.start(Counts, KEEPER, threads)
    assert isinstance(host.node.executor, MultiThreadedExecutor) == wanted


class Tells(Node):
    def __init__(self) -> None:
        super().__init__("tells")

    def kind(self) -> str:
        return type(self.executor).__name__


@pytest.mark.parametrize("runs", [True, False])
def test_the_answer_has_threads_where_the_student_s_node_runs_with_them_now(test_domain: int, runs: bool) -> None:
    ros_context.start()
    executor, node = MultiThreadedExecutor(2), Tells()
    executor.add_node(node)
    if not runs:
        executor.remove_node(node)
    names, order = {"Tells": Tells, "node": node}, {"domain": test_domain, "node_class": "Tells"}
    try:
        assert obey({**order, "do": "start", "keeper": KEEPER, "threads": None}, names, 20.0) == {"value": None}
        kind = obey({**order, "do": "call", "method": "kind", "arguments": []}, names, 20.0)["value"]
    finally:
        close()
        executor.shutdown()
        node.destroy_node()
    assert (kind == "MultiThreadedExecutor") == runs


def test_a_check_that_is_late_publishes_no_two_messages_at_once(
    examination: Examination, monkeypatch: pytest.MonkeyPatch
) -> None:
    words = publisher("/words", String)
    moments: list[float] = []
    real = words.publish

    def publish(message: String) -> None:
        real(message)
        if not moments:
            time.sleep(0.3)
        moments.append(time.monotonic())

    monkeypatch.setattr(words, "publish", publish)
    publish_steadily(words, [String()] * 10, period=0.1)
    shortest = min(after - before for before, after in pairwise(moments))
    assert 0.05 <= shortest < 0.095  # some of the time is made up for, but not all at once
