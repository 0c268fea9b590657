"""Every public function refuses what makes no sense: in one sentence of ours, at once, and nothing is printed."""

from __future__ import annotations

import contextlib
import io
import linecache
import math
import signal
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import Twist, Vector3
from rclpy.node import Node
from turtlesim.msg import Pose

import course_kit
import course_kit.base.arguments
from course_kit.exercises import faults
from course_kit.lab import bags
from course_kit.lab.calls.conversations import plot_conversation
from course_kit.lab.calls.goal_plots import plot_goals
from course_kit.lab.calls.sequences import plot_calls
from course_kit.lab.calls.service_calls import calls_of
from course_kit.robots.robot.node import Robot
from course_kit.robots.turtlesim.node import TurtleSim
from course_kit.ros.graph import discovery
from course_kit.ros.graph.action_plots import plot_action
from course_kit.setup.colcon.install_plots import plot_install
from course_kit.views.live.turtle import drive

LONGEST = 2.0  # seconds that a refusal may take, without what a call waits for
LIMIT = 4000  # letters that it may print, or say
SOURCES = str(Path(course_kit.__file__).parent)
POSE = "/turtle1/pose"
PLACE = Path(__file__).parent / "no such folder"
NOTHING: dict[str, Any] = {}

HALF = "\ud800"  # half of a surrogate pair, which no encoding has
NO_NUMBER: list[Any] = [None, "x", "", [], {}, b"1", object(), HALF, 1j, True, np.zeros((1000, 1000))]
NO_TIME = [*NO_NUMBER, math.nan, math.inf, -math.inf, 1e300, 10**400, np.float64("nan")]
NO_SPAN = [*NO_TIME, 0, 0.0, -1, -1e-9]
NO_COUNT = [*NO_NUMBER, 0, -1, 1.5, math.nan, math.inf, 10**30]
NO_TEXT = [3, 1.5, b"text", [], {}, HALF, "a\0b", object(), math.nan]
NO_PATH = [None, 3, "", " ", b"bag", [], {}, HALF, "a\0b", math.nan, object()]
NO_NODE = [3, "", "a b", "1a", "a//b", "/a-b", "é", HALF, b"a", [], object(), math.nan, "a" * 100_000 + "!"]
NO_NAMESPACE = [value for value in NO_NODE if value != ""]
NO_TOPIC = [None, 3, "", " ", "/a b", "/1a", "a//b", "/a-b", "/é", HALF, b"/a", [], object(), "/" + "a" * 100_000]
NO_FIELD = [None, 3, "", "z", "x.y", "x[0]", ".x", "x[", "é", HALF, "a\0b", [], object(), "x" * 100_000]
NO_PLACES = [None, 3, "text", {}, object(), [3.0], [(1.0,)], [(1.0, 2.0, 3.0)], ["ab"], [(1.0, math.nan)], [(True, 1)]]
NO_RECORDING = [None, 3, "text", [], {}, object(), math.nan]


def or_none(values: list[Any]) -> list[Any]:
    """The bad ones where None is allowed."""
    return [value for value in values if value is not None]


class Idle(Node):
    """A node that does nothing."""

    def __init__(self) -> None:
        super().__init__("idle")


class Follower(Node):
    """Turns as the turtle is."""

    def __init__(self) -> None:
        super().__init__("follower")
        self.turns = self.create_publisher(Twist, "/turn", 10)
        self.create_subscription(Pose, POSE, self.turn, 10)

    def turn(self, pose: Pose) -> None:
        """Publish how far she is."""
        self.turns.publish(Twist(angular=Vector3(z=pose.theta)))


class Row:
    """A function, arguments that are right, and by the argument's name or place what is wrong in their stead."""

    def __init__(self, call: Callable[..., Any], *right: Any, keywords: dict[str, Any] = NOTHING, **wrong: list[Any]):
        self.call, self.right, self.keywords, self.wrong = call, right, keywords, wrong
        self.name = f"{call.__module__.removeprefix('course_kit.')}.{call.__qualname__}"

    def calls(self) -> Iterator[tuple[str, Callable[[], Any]]]:
        """Every wrong call, with its name."""
        for name, values in self.wrong.items():
            for value in values:
                right, keywords = list(self.right), dict(self.keywords)
                if name.startswith("place"):
                    number = int(name[5:])
                    right[number : number + 1] = [value]
                else:
                    keywords[name] = value
                told = course_kit.base.arguments.shown(value)
                yield f"{name}={told}", partial(self.call, *right, **keywords)


THINGS: dict[str, Any] = {}  # what functions return, for the calls of its methods


def method(thing: str, name: str) -> Callable[..., Any]:
    """A method of one of the things, which are not there yet."""

    def call(*arguments: Any, **keywords: Any) -> Any:
        return getattr(THINGS[thing], name)(*arguments, **keywords)

    call.__qualname__ = f"{thing}.{name}"
    return call


@pytest.fixture(scope="module", autouse=True)
def turtle(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """A turtle that runs, a bag of her poses, and what looks at her."""
    bag = tmp_path_factory.mktemp("bags") / "drive"
    with course_kit.running(TurtleSim):
        with bags.record(bag, POSE) as recording:
            course_kit.wait_for(lambda: recording.message_count > 10, 10.0)
        THINGS["recording"] = course_kit.record(POSE, count=3)
        THINGS["topic"] = THINGS["recording"][POSE]
        THINGS["values"] = course_kit.values(f"{POSE}.x", source=bag)
        THINGS["meter"] = course_kit.measure_rates(POSE)
        THINGS["resources"] = course_kit.record_resources()
        THINGS["process"] = course_kit.start("sleep 100")
        THINGS["workspace"] = course_kit.Workspace(bag.parent / "ws")
        THINGS["replayed"] = course_kit.replay(bag, Follower)
        yield
        course_kit.stop()
        THINGS.clear()


ROWS = [
    Row(course_kit.run, Idle, executor=or_none(NO_RECORDING)),
    Row(course_kit.run, place0=[None, 3, "talker", [], {}, math.nan, HALF, object(), int, str]),
    Row(
        course_kit.run,
        Robot,
        world=[*NO_TEXT, None, "", "mars"],
        seed=[*or_none(NO_NUMBER), -1, 1.5, 10**30],
        start=[3, "here", {}, object(), (0.0, 0.0), (0.0, 0.0, math.nan), [HALF] * 3, (1e9, 0.0, 0.0)],
        factor=[*or_none(NO_NUMBER), -1, math.nan, math.inf, 10**400],
    ),
    Row(course_kit.stop, place0=[*NO_NODE, None, {}, "no_such_node", int]),
    Row(course_kit.wait_for, lambda: False, timeout=NO_TIME, what=NO_TEXT),
    Row(course_kit.wait_for, place0=[None, 3, "x", [], {}, math.nan]),
    Row(course_kit.catch_up, place0=[*NO_TEXT, None, "", "topics", "no-such-cell"]),
    Row(course_kit.solution, place0=[*NO_TEXT, None, "", "setup", "setup-99", "../setup-1", "a" * 100_000]),
    Row(course_kit.log_level, "/turtlesim", place0=[*NO_NODE, None], timeout=NO_TIME),
    Row(course_kit.set_log_level, "/turtlesim", "INFO", place0=[*NO_NODE, None], place1=[*NO_TEXT, None, "", "LOUD"]),
    Row(course_kit.set_log_level, "/turtlesim", "INFO", timeout=NO_TIME),
    Row(course_kit.Workspace, place0=NO_PATH),
    Row(course_kit.start, place0=[None, 3, "", " ", [], b"ls", math.nan, object(), HALF, "a\0b", [""], [HALF]]),
    Row(course_kit.start, "true", name=or_none(NO_TEXT), folder=or_none(NO_PATH)),
    Row(
        course_kit.start, "true", environment=[3, "x", [], {"A": 3}, {3: "A"}, {"A=": "B"}, {"A": "a\0b"}, {"A": HALF}]
    ),
    Row(
        course_kit.show_form,
        "/turtle1/cmd_vel",
        place0=NO_TOPIC,
        interface=[3, [], {}, "", "Twist", "a/b/c/d", HALF, object(), int, Twist(), "no_such/msg/Type", Pose, Idle],
        timeout=NO_TIME,
    ),
    Row(course_kit.show_form, place0=["/nobody"], keywords={"timeout": 0.1}),
    Row(course_kit.watch_logs, node=NO_NODE, level=[*NO_TEXT, None, "", "LOUD"]),
    Row(course_kit.watch_rates, place0=NO_TOPIC, last=NO_SPAN, period=NO_SPAN, seconds=NO_SPAN),
    Row(course_kit.watch_resources, period=NO_SPAN, seconds=NO_SPAN),
    Row(course_kit.watch_values, f"{POSE}.x", span=NO_SPAN, period=NO_SPAN, seconds=NO_SPAN, timeout=NO_TIME),
    Row(
        course_kit.watch_values,
        place0=[*NO_TOPIC, f"{POSE}.", f"{POSE}.x.", f"{POSE}.x[0]", f"{POSE}.y\0", f"{POSE}.{HALF}"],
    ),
    Row(course_kit.log_files, program=[None, 1.5, b"x", [], {}, object()], last=NO_COUNT),
    Row(course_kit.logs, node=NO_NODE, level=[*NO_TEXT, None, "", "LOUD"], last=NO_COUNT, text=[*NO_TEXT, None]),
    Row(course_kit.log_rates, seconds=NO_SPAN),
    Row(course_kit.rates, POSE, place0=NO_TOPIC, seconds=NO_SPAN, window=NO_COUNT, timeout=NO_TIME),
    Row(course_kit.measure_rates, POSE, place0=NO_TOPIC, window=NO_COUNT, timeout=NO_TIME),
    Row(course_kit.record, POSE, place0=NO_TOPIC, seconds=or_none(NO_SPAN), count=or_none(NO_COUNT)),
    Row(course_kit.record, POSE, keep=or_none(NO_COUNT), max_bytes=NO_COUNT, timeout=NO_TIME),
    Row(
        course_kit.record,
        POSE,
        "x",
        place1=[None, 3, "std_msgs/msg/", "no_such/msg/Type", "std_msgs/msg/Strin", int, HALF],
    ),
    Row(course_kit.plot_pose, place0=NO_RECORDING),
    Row(course_kit.plot_pose, None, goals=NO_PLACES),
    Row(course_kit.plot_rates, place0=NO_RECORDING),
    Row(course_kit.plot_values, f"{POSE}.x", seconds=NO_SPAN, title=or_none(NO_TEXT)),
    Row(course_kit.plot_values, place0=[None, 3, [], {}, object(), "", HALF]),
    Row(course_kit.plot_resources, place0=NO_RECORDING),
    Row(course_kit.plot_comparison, place0=NO_RECORDING),
    Row(
        course_kit.plot_scene,
        place0=[None, 3, [], {}, object(), "", HALF, np.zeros(3)],
        frame=or_none(NO_TEXT),
        timeout=NO_TIME,
    ),
    Row(course_kit.plot_frames, place0=or_none(NO_RECORDING)),
    Row(course_kit.plot_frames, seconds=NO_SPAN, namespace=NO_NAMESPACE),
    Row(course_kit.plot_graph, node=[*NO_NODE, "no_such_node"], namespace=NO_NAMESPACE),
    Row(course_kit.show_graph, node=[*NO_NODE, "no_such_node"], namespace=NO_NAMESPACE),
    Row(course_kit.show_robot, place0=[*NO_NAMESPACE, None, {}, int, Idle]),
    Row(course_kit.record_resources, seconds=or_none(NO_SPAN), period=NO_SPAN),
    Row(course_kit.values, f"{POSE}.x", seconds=NO_SPAN, timeout=NO_TIME, source=[3, [], {}, "", HALF, object()]),
    Row(
        course_kit.values,
        place0=[*NO_TOPIC, f"{POSE}.z", f"{POSE}.", f"{POSE}..x", f"{POSE}.x[0]", f"{POSE}.x[", f"{POSE}.{HALF}"],
    ),
    Row(course_kit.save_csv, place0=NO_RECORDING, keywords={"file": "x.csv"}),
    Row(course_kit.compare, PLACE, PLACE, place0=NO_PATH, place1=NO_PATH, tolerance=[*NO_NUMBER, math.nan, -1]),
    Row(course_kit.replay, PLACE, Idle, place0=NO_PATH, place1=[None, 3, "x", [], int, object()], timeout=NO_SPAN),
    Row(bags.record, PLACE, place0=NO_PATH, place1=NO_TOPIC, storage=[*NO_TEXT, None, "", "rosbag"]),
    Row(bags.read, PLACE, place0=NO_PATH),
    Row(bags.info, place0=[*NO_PATH, PLACE, "/dev/null"]),
    Row(bags.reindex, place0=[*NO_PATH, PLACE, "/dev/null"]),
    Row(bags.play, PLACE, place0=NO_PATH, rate=[*NO_NUMBER, 0, -1, math.nan, math.inf]),
    Row(calls_of, place0=[None, 3, "x", [3], [None], object()]),
    Row(plot_calls, place0=NO_RECORDING),
    Row(course_kit.plot_executor, place0=NO_RECORDING),
    Row(course_kit.plot_callback_times, [], [], place0=NO_RECORDING, place1=[None, 3, "text", {}, object(), ["x"]]),
    Row(plot_goals, place0=NO_RECORDING),
    Row(plot_conversation, None, [], place0=NO_RECORDING, place1=[None, 3, "x", [3], {}, object()]),
    Row(plot_action, place0=[*NO_TEXT, None, "no_such_action"]),
    Row(plot_install, "no workspace", "hello", place0=NO_RECORDING),
    Row(drive, turtle=[*NO_NODE, None], namespace=NO_NAMESPACE),
    Row(faults.is_repaired, timeout=NO_TIME),
    Row(method("recording", "__getitem__"), place0=NO_TOPIC),
    Row(method("recording", "values"), place0=NO_FIELD),
    Row(method("topic", "values"), place0=NO_FIELD),
    Row(method("values", "__getitem__"), place0=[*NO_TOPIC, f"{POSE}.z"]),
    Row(method("meter", "read"), last=or_none(NO_SPAN)),
    Row(method("meter", "arrivals"), place0=[*NO_TOPIC, "/not_measured"]),
    Row(method("resources", "of"), place0=[*NO_NODE, None, "no_such_node"]),
    Row(method("resources", "__getitem__"), place0=[None, 3, "", "x", HALF, object()]),
    Row(method("process", "wait"), timeout=NO_TIME),
    Row(method("process", "says"), place0=[*NO_TEXT, None]),
    Row(method("process", "stop"), patience=NO_TIME),
    Row(method("process", "send_signal"), place0=[None, "x", 1.5, -1, 0, 1000, 10**30, object(), True]),
    Row(method("workspace", "reset"), place0=[*NO_TEXT, None, "", "..", "../x", "a/b", " "]),
    Row(method("workspace", "build"), place0=[*NO_TEXT, None]),
    Row(method("workspace", "start"), "true", place0=[None, 3, "", [], HALF, object()], name=or_none(NO_TEXT)),
    Row(method("replayed", "__getitem__"), place0=[*NO_TOPIC, "/not_published"]),
    Row(method("replayed", "save"), place0=NO_PATH),
    Row(faults.process, place0=[*NO_TEXT, None, "", "robot"]),
]


def out_of_time(*_: Any) -> None:
    raise InterruptedError("it was not over in time")


def problem(call: Callable[[], Any], is_again: bool = False) -> str | None:
    """What is wrong with how a call is refused, if anything is."""
    said = io.StringIO()
    signal.signal(signal.SIGALRM, out_of_time)
    signal.setitimer(signal.ITIMER_REAL, 15.0)
    began = time.monotonic()
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            call()
    except Exception as error:
        told, traceback = str(error), error.__traceback__
        while traceback is not None and traceback.tb_next is not None:
            traceback = traceback.tb_next
        assert traceback is not None
        file, line = traceback.tb_frame.f_code.co_filename, traceback.tb_lineno
        seen = f"{type(error).__name__}: {told[:200]!r}"
        if not file.startswith(SOURCES):
            return f"inner error in {file}: {seen}"
        if "raise " not in linecache.getline(file, line) + linecache.getline(file, line - 1):
            return f"inner error in {Path(file).name}:{line}: {seen}"
        if len(told) > 600 or "\n" in told or len(told.split()) < 4:
            return f"no sentence: {seen}"
        if not course_kit.base.arguments.is_text(told):
            return f"cannot be printed: {seen}"
    else:
        return "accepted"
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
    if (took := time.monotonic() - began) > LONGEST:
        # The middleware may hold Python's lock for 2 s, for what a killed process of another test has left: once.
        return problem(call, is_again=True) if not is_again else f"took {took:.1f} s: {seen}"
    if said.getvalue():
        return f"printed {said.getvalue()[:100]!r}"
    return None


@pytest.mark.parametrize("row", ROWS, ids=[f"{number}-{row.name}" for number, row in enumerate(ROWS)])
def test_it_is_refused_in_one_sentence(row: Row) -> None:
    wrong = [f"{name}: {found}" for name, call in row.calls() if (found := problem(call))]
    assert not wrong, "\n" + "\n".join(wrong)


NO_PART: dict[str, Callable[[], Any]] = {
    "a topic in a scene": lambda: course_kit.plot_scene(""),
    "a node in a graph": lambda: course_kit.plot_graph("a b"),
    "a namespace in a graph": lambda: course_kit.plot_graph(namespace="a b"),
    "a node in a live graph": lambda: course_kit.show_graph("a b"),
    "a namespace in a live graph": lambda: course_kit.show_graph(namespace="a b"),
}


@pytest.mark.parametrize("what", NO_PART)
def test_a_name_that_none_can_have_is_refused_before_the_graph_is_known(
    what: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(discovery, "of", lambda *_, **__: pytest.fail("it waits for the graph"))
    with pytest.raises(ValueError, match=r"cannot be the name of a topic|must be (the name of a node|a namespace)"):
        NO_PART[what]()


NO_EXERCISE = [None, 3, "", "setup", "setup-99", [], b"setup-1", HALF, "a" * 100_000, object()]
NO_VALUE = [np.zeros((1000, 1000)), HALF, HALF * 10**6, object(), {1: 2}, math.nan, 10**400]
CHECKED: list[tuple[Any, Any]] = [
    *((exercise, None) for exercise in NO_EXERCISE),
    *(("setup-1", value) for value in NO_VALUE),
    *(("topics-1", value) for value in [3, "x"]),
]


@pytest.mark.parametrize("number", range(len(CHECKED)))
def test_a_check_says_in_a_line_what_it_cannot_look_at(number: int, capfd: pytest.CaptureFixture[str]) -> None:
    exercise, value = CHECKED[number]
    course_kit.check(exercise, value)
    said = "".join(capfd.readouterr())
    assert said and len(said) < LIMIT and "Traceback" not in said and "Error(" not in said, said[:1000]


WAITING: dict[str, Callable[[], Any]] = {
    "wait_for": lambda: course_kit.wait_for(lambda: False, 60.0),
    "wait_for a process": lambda: course_kit.wait_for(THINGS["process"], 60.0),
    "log_level": lambda: course_kit.log_level("/nobody", 60.0),
    "rates": lambda: course_kit.rates(POSE, seconds=60.0),
    "measure_rates": lambda: course_kit.measure_rates("/nobody", timeout=60.0),
    "record a topic": lambda: course_kit.record("/nobody", timeout=60.0),
    "record for a time": lambda: course_kit.record(POSE, seconds=60.0),
    "record a count": lambda: course_kit.record(POSE, count=10**6, timeout=60.0),
    "values": lambda: course_kit.values("/nobody.x", timeout=60.0),
    "plot_scene": lambda: course_kit.plot_scene("/nobody", timeout=60.0),
    "plot_frames": lambda: course_kit.plot_frames(seconds=60.0),
    "record_resources": lambda: course_kit.record_resources(seconds=60.0),
    "process": lambda: THINGS["process"].wait(60.0),
    "plot_values": lambda: course_kit.plot_values(f"{POSE}.x", seconds=60.0),
}


@pytest.mark.parametrize("name", WAITING)
def test_an_interrupt_ends_it_at_once(name: str) -> None:
    signal.signal(signal.SIGALRM, lambda *_: signal.raise_signal(signal.SIGINT))
    signal.setitimer(signal.ITIMER_REAL, 0.5)
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        WAITING[name]()
    assert time.monotonic() - began < 0.5 + LONGEST


def test_there_are_enough_of_them() -> None:
    assert sum(len(list(row.calls())) for row in ROWS) + len(CHECKED) > 300
