"""The contract with rclpy: what the course uses beside its public interface, and what it does where that is another."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
import rclpy
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import String
from std_srvs.srv import Empty

from course_kit.lab.background import guards
from course_kit.ros.private_api import TRIED_RCLPY, package_version, rclpy_message_parts, rclpy_parts, untried
from course_kit.ros.spinning import context
from tests.kernel import Kernel
from tests.waiting import wait_until

pytestmark = pytest.mark.by_turns("many nodes and programs")

WITH_A_TALKER = """
import sys
import rclpy, rclpy.action.server, rclpy.experimental
from rclpy.action import ActionClient, ActionServer
from rclpy.client import Client
from rclpy.executors import Executor
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Empty
from course_kit import record, run, stop, wait_for
from course_kit.ros.private_api import rclpy_message_parts, rclpy_parts
from course_kit.ros.subscriptions import observer_node

class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        self.publisher = self.create_publisher(String, "chatter", 10)
        self.count = 0
        self.create_timer(0.01, self.tick)

    def tick(self):
        self.count += 1
        self.publisher.publish(String(data=str(self.count)))

def with_another_parameter(owner, name):
    plain = getattr(owner, name)
    def other(*args, new=None, **kwargs):
        return plain(*args, **kwargs)
    setattr(owner, name, other)

def talk():
    talker = run(Talker)
    wait_for(lambda: talker.count > 3)
    print("talks", file=sys.stderr)
    return talker
"""
GUARDED = [(owner.__name__, name) for owner, name, *_ in guards.GUARDS]
SENT = [("ActionClient", name) for name in ("send_goal_async", "_cancel_goal_async", "_get_result_async", "execute")]


def said(code: str) -> list[str]:
    """What a process of its own prints on stderr."""
    done = subprocess.run([sys.executable, "-c", WITH_A_TALKER + code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    return done.stderr.splitlines()


@pytest.fixture
def node():
    context.start()
    made = Node("sentry")
    yield made
    made.destroy_node()


# ---- As it is installed


def test_the_installed_release_is_one_that_the_tests_run_with():
    assert package_version("rclpy") in TRIED_RCLPY
    assert untried(package_version("rclpy")) == ""


def test_every_guard_fits_and_is_put_in_place_once():
    guards.install()
    places = [*((owner, name) for owner, name, *_ in guards.GUARDS), *((ActionClient, name) for _, name in SENT)]
    guarded = [getattr(owner, name) for owner, name in places]
    assert all(hasattr(function, "is_guard_of_the_course") for function in guarded)
    guards.install()
    assert [getattr(owner, name) for owner, name in places] == guarded
    assert rclpy.spin.__doc__ and "block until" in rclpy.spin.__doc__
    assert said("talk()") == ["talks"]


def test_a_client_keeps_the_futures_of_its_requests(node):
    client = node.create_client(Empty, "nobody")
    future = client.call_async(Empty.Request())
    assert rclpy_parts.pending_requests(client) == [future]


def test_the_fast_executor_is_the_one_for_events(node):
    executor = rclpy_parts.fast_executor(node.context)
    assert rclpy_parts.is_fast(executor) and "EventsExecutor" in type(executor).__name__
    executor.shutdown()


@pytest.mark.parametrize(
    "kind", [rclpy_message_parts.CppReception, lambda c: rclpy_message_parts.PublicReception(c, "_own")]
)
def test_serialised_messages_come_with_their_info_and_what_the_middleware_says(node, kind):
    """By the C++ module, and as the public ways give the same."""
    reception = kind(node.context)
    taker = reception.open(node, String, "/serialised", rclpy.qos.QoSProfile(depth=10))
    publisher = node.create_publisher(String, "/serialised", 10)
    wait_until(lambda: publisher.get_subscription_count() == taker.publisher_count() == 1)
    publisher.publish(String(data="here"))
    with reception.looks_at([taker]) as look:
        wait_until(lambda: look()[0].messages)
        data, info = taker.take()
        assert b"here" in data and info["received_timestamp"] > info["source_timestamp"] > 0
        assert taker.take() is None and look() == [(False, False, False)]
        best_effort = rclpy.qos.QoSProfile(depth=1, reliability=rclpy.qos.ReliabilityPolicy.BEST_EFFORT)
        refused = node.create_publisher(String, "/serialised", best_effort)
        wait_until(lambda: look()[0].refused)
        assert taker.take_refused().last_policy_kind == rclpy.qos.QoSPolicyKind.RELIABILITY
    taker.destroy()
    with reception.looks_at([]) as look:
        wait_until(lambda: look() or publisher.get_subscription_count() == 0)
    assert refused.get_subscription_count() == 0
    assert taker.publisher_count() == 0
    reception.close()


# ---- As another release may be


@pytest.mark.parametrize(("owner", "name"), GUARDED + SENT)
def test_a_function_with_other_arguments_stays_as_it_is_and_one_line_says_what_that_means(owner, name):
    line, talks = said(f"with_another_parameter({owner}, {name!r}); talk(); assert {owner}.{name}.__name__ == 'other'")
    assert line.startswith(f"course_kit: rclpy's {name}() takes other arguments here: ")
    assert talks == "talks"


@pytest.mark.parametrize(("owner", "name"), [("rclpy", "spin"), ("Client", "call"), ("ActionClient", "send_goal")])
def test_a_function_that_is_not_there_is_named(owner, name):
    line, talks = said(f"del {owner}.{name}; talk()")
    assert line.startswith(f"course_kit: rclpy has no {owner}.{name} here: ")
    assert talks == "talks"


def test_where_action_servers_execute_otherwise_what_that_means_is_said():
    line, talks = said("with_another_parameter(rclpy.action.server, 'await_or_execute'); talk()")
    assert line == (
        "course_kit: rclpy's await_or_execute() takes other arguments here: "
        "what an execute callback raises is seen in logs() alone"
    )
    assert talks == "talks"


def test_without_the_executor_for_events_nodes_run_in_the_usual_one():
    lines = said(
        "del rclpy.experimental.EventsExecutor; talker = talk()\n"
        "print(type(talker.executor).__name__, type(observer_node.executor()).__name__, file=sys.stderr)"
    )
    assert lines == [
        "course_kit: rclpy has no experimental.EventsExecutor here: what nodes receive takes three times as long",
        "talks",
        "SingleThreadedExecutor SingleThreadedExecutor",
    ]


def test_where_a_client_keeps_its_requests_otherwise_the_service_is_not_named():
    lines = said("""
client = talk().create_client(Empty, "nobody")
future = client.call_async(Empty.Request())
del client._pending_requests
for attempt in range(2):
    try:
        wait_for(future, timeout=0.1)
    except TimeoutError as error:
        print(str(error).split(". ")[0], file=sys.stderr)
""")
    assert lines == [
        "talks",
        "course_kit: rclpy has no Client._pending_requests here: wait_for() does not say what is waited for",
        *["the result of the future did not come within 0.1 s"] * 2,
    ]


def test_where_loggers_keep_their_children_otherwise_a_node_ends_all_the_same():
    lines = said("""
from rclpy.impl.rcutils_logger import RcutilsLogger
del RcutilsLogger.__del__
stop(talk())
stop(talk())
""")
    lost = "action servers of a node that is run again may log to the terminal alone"
    assert lines == ["talks", f"course_kit: rclpy has no RcutilsLogger.__del__ here: {lost}", "talks"]


@pytest.mark.parametrize("name", rclpy_message_parts.CPP)
def test_beside_another_cpp_module_topics_are_recorded_through_an_executor(name):
    lines = said(f"""
rclpy_message_parts.CPP[{name!r}] += ("of_tomorrow",)
talk()
with record("/chatter") as recording:
    wait_for(lambda: len(recording) > 20)
print(all(bytes(serialised) for serialised in recording["/chatter"].serialised), file=sys.stderr)
""")
    slow = "recording and measuring go through an executor, which takes ten times the processor"
    assert lines == [f"course_kit: rclpy has no {name}.of_tomorrow here: {slow}", "talks", "True"]


def test_a_wait_set_that_takes_other_arguments_is_found():
    lines = said("""
from rclpy.impl import implementation_singleton as singleton
cpp = singleton.rclpy_implementation
class Module:
    WaitSet = type("WaitSet", (), dict.fromkeys(rclpy_message_parts.CPP["WaitSet"]))
    def __getattr__(self, name):
        return getattr(cpp, name)
singleton.rclpy_implementation = Module()
talk()
""")
    assert lines[0].startswith("course_kit: rclpy's WaitSet() takes other arguments here: recording and measuring")
    assert lines[1:] == ["talks"]


# ---- What a kernel says


def test_what_is_said_at_a_kernels_start_comes_with_its_first_cell():
    lines = said("""
from IPython.core.interactiveshell import InteractiveShell
from course_kit.views.live.kernel_start import load_ipython_extension
with_another_parameter(rclpy, "spin")
shell = InteractiveShell.instance(user_ns=globals())
load_ipython_extension(shell)
print("started", file=sys.stderr)
shell.run_cell("talk();")
shell.run_cell("talk();")
""")
    spin = "course_kit: rclpy's spin() takes other arguments here: a cell with rclpy.spin() cannot be interrupted"
    assert lines == ["started", spin, "talks", "talks"]


def test_beside_another_release_the_first_cell_says_so_and_the_kernel_goes_on(tmp_path: Path, monkeypatch):
    told = tmp_path / "share/rclpy/package.xml"
    told.parent.mkdir(parents=True)
    told.write_text('<package format="3">\n  <version>7.1.9</version>\n</package>')
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{tmp_path}{os.pathsep}{os.environ['AMENT_PREFIX_PATH']}")
    kernel = Kernel()
    try:
        first = kernel.run("from rclpy.node import Node\nfrom course_kit import nodes, run\nrun(Node, 'goes_on');")
        line = f"course_kit: the course was tried with rclpy {TRIED_RCLPY[-1]}; what does not work with 7.1.9 says so\n"
        kernel.until(lambda: line in kernel.text(first))
        assert kernel.text(kernel.run("print(len(nodes()))")) == "1\n"
    finally:
        kernel.close()


def test_an_error_in_a_callback_leaves_nothing_of_the_executor_in_the_future_that_ends_it():
    class Failing:
        """Leaves its callback in the future when a callback of a node fails, as rclpy's EventsExecutor does."""

        is_alive = True

        def spin_until_future_complete(self, future: Future, timeout_sec: float) -> None:
            future.add_done_callback(lambda _: calls.append(self.is_alive))
            raise ValueError("of a callback")

    calls: list[bool] = []
    until, executor = Future(), Failing()
    with pytest.raises(ValueError, match="of a callback"):
        rclpy_parts.spin_some(executor, until)  # type: ignore[arg-type]
    executor.is_alive = False
    until.set_result(None)
    assert False not in calls
